// The rig's side of the bus description drivers/can/patella.dbc: what it sends, and the command it obeys.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/sequence_counter.hpp"
#include "drivers/can/signal_codec.hpp"
#include "sim/drive.hpp"

namespace patella::sim {

/// A message of the description with the signals that the rig uses, and its Counter and Crc where it has
/// them. The constructor throws std::invalid_argument when the message or a signal is not there.
class RigMessage {
 public:
  RigMessage(const can::Database& database, std::string_view message,
             std::initializer_list<std::string_view> signals);

  /// A frame of this message with the next counter. Values in the order of the constructor's signals; what a
  /// signal cannot hold saturates.
  can::Frame encode(std::initializer_list<double> values) noexcept PATELLA_NONBLOCKING;

  bool matches(const can::Frame& frame) const noexcept PATELLA_NONBLOCKING;
  /// True for a frame of full length and right CRC whose counter is not that of the last such frame.
  bool authentic(const can::Frame& frame) noexcept PATELLA_NONBLOCKING;
  double decode(const can::Frame& frame, std::size_t signal) const noexcept PATELLA_NONBLOCKING {
    return signals_[signal].decode(frame);
  }

 private:
  can::Frame blank_;
  std::vector<can::CompiledSignal> signals_;
  std::optional<can::CompiledSignal> counter_;
  std::optional<can::CompiledSignal> crc_;
  std::size_t crc_byte_ = 0;
  std::uint64_t next_counter_ = 0;
  can::SequenceCounter sequence_{8};
};

class RigMessages {
 public:
  /// For 1 or 2 joints; a single joint has Encoder1 and leaves the second torque and f_u at zero.
  RigMessages(const can::Database& database, int joints);

  can::Frame encoder(std::size_t joint, double position_rad,
                     double velocity_rad_s) noexcept PATELLA_NONBLOCKING;
  can::Frame driveStatus(const JointVector& torque_Nm, bool enabled,
                         DriveFault fault) noexcept PATELLA_NONBLOCKING;
  can::Frame emg(const EmgArray& signal_mV) noexcept PATELLA_NONBLOCKING;
  can::Frame truth(const JointVector& f_u_rad_s2) noexcept PATELLA_NONBLOCKING;
  can::Frame operatorButtons(bool enable, bool reset) noexcept PATELLA_NONBLOCKING;

  bool isCommand(const can::Frame& frame) const noexcept PATELLA_NONBLOCKING {
    return command_.matches(frame);
  }
  /// False, and nothing stored, when the command is not authentic. A counter that jumped is taken: the drive
  /// wants the newest command, and its watchdog judges the gaps.
  bool decodeCommand(const can::Frame& frame, JointVector& torque_Nm,
                     bool& enable) noexcept PATELLA_NONBLOCKING;

 private:
  std::vector<RigMessage> encoders_;
  RigMessage drive_status_;
  RigMessage emg_;
  RigMessage truth_;
  RigMessage operator_;
  RigMessage command_;
};

}  // namespace patella::sim
