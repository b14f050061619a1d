// The rig's side of the bus description drivers/can/patella.dbc: what it sends, and the command it obeys.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/message_codec.hpp"
#include "sim/drive.hpp"

namespace patella::sim {

/// A message that is always sent with the same signals; with a Counter and a Crc where the description has
/// both.
class OutgoingMessage {
 public:
  /// Throws std::invalid_argument when the message or a signal is not there.
  OutgoingMessage(const can::Database& database, std::string_view message,
                  std::initializer_list<std::string_view> signals);

  /// The next frame. Values in the order of the constructor's signals; what a signal cannot hold saturates.
  can::Frame make(std::initializer_list<double> values) noexcept PATELLA_NONBLOCKING;
  void restart() noexcept { encoder_.restart(); }

 private:
  can::MessageEncoder encoder_;
  std::vector<std::size_t> slots_;
};

class RigMessages {
 public:
  /// The rig's own messages carry 1 or 2 joints; a single joint has Encoder1 and leaves the second torque and
  /// f_u at zero. With drives that are nodes of their own, these send positions and obey commands, of any
  /// number of joints, and of the rig's own messages the operator's alone has to be there. Truth has f_u of
  /// joints 1 and 2, Truth2 of 3 and 4, and so on. Throws std::invalid_argument for more joints without such
  /// drives, and where a message or signal is missing.
  RigMessages(const can::Database& database, int joints, bool field_drives);

  can::Frame encoder(std::size_t joint, double position_rad,
                     double velocity_rad_s) noexcept PATELLA_NONBLOCKING;
  can::Frame driveStatus(const JointVector& torque_Nm, bool enabled,
                         DriveFault fault) noexcept PATELLA_NONBLOCKING;
  can::Frame emg(const EmgArray& signal_mV) noexcept PATELLA_NONBLOCKING;
  /// That of one of truthFrames().
  can::Frame truth(std::size_t index, const JointVector& f_u_rad_s2) noexcept PATELLA_NONBLOCKING;
  can::Frame operatorButtons(bool enable, bool reset) noexcept PATELLA_NONBLOCKING;

  bool hasEmg() const noexcept { return emg_.has_value(); }
  std::size_t truthFrames() const noexcept { return truth_.size(); }
  bool isCommand(const can::Frame& frame) const noexcept PATELLA_NONBLOCKING {
    return command_ && command_->matches(frame);
  }
  /// False, and nothing stored, where CRC or length is wrong or the counter repeats. A counter that jumped is
  /// taken: the drive wants the newest command, and its watchdog judges the gaps.
  bool decodeCommand(const can::Frame& frame, JointVector& torque_Nm,
                     bool& enable) noexcept PATELLA_NONBLOCKING;

  /// All counters start at zero again.
  void restart() noexcept;

 private:
  std::vector<OutgoingMessage> encoders_;
  std::optional<OutgoingMessage> drive_status_;
  std::optional<OutgoingMessage> emg_;
  std::vector<OutgoingMessage> truth_;
  OutgoingMessage operator_;
  std::optional<can::MessageDecoder> command_;
  std::vector<std::size_t> command_torques_;
  std::size_t command_enable_ = 0;
};

}  // namespace patella::sim
