// Which signal of which message feeds which input: what configuration fills in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/bounds/bounds.hpp"
#include "drivers/can/message_codec.hpp"

namespace patella::can {

/// Quantity inside = scale * signal + offset, whichever way it travels. Joints and channels count from 1 in
/// the names.
struct Binding {
  std::string input;  ///< such as "position_rad.1", "drive_fault"; see MeasurementDecoder and CommandEncoder
  std::string message;
  std::string signal;
  double scale = 1.0;
  double offset = 0.0;
  bool shared = false;         ///< its signal feeds other inputs too, each of which says so
  std::string scale_reason{};  ///< what scale holds besides the change of units, a gear say; else the DBC's
                               ///< unit has to agree with it
  std::string origin{};        ///< where it was written, "file:line: key 'input[2]'"; for messages
  /// Of a status: values that mean enabled, or no fault. Empty: enabled is more than 0.5, no fault is 0.
  std::vector<double> good{};
  /// Of a status: bits of its whole number that count; 0: all.
  std::uint32_t mask = 0;
};

struct BusMap {
  std::vector<Binding> bindings;
  std::vector<Protection> protections;

  /// Longest age of the newest valid frame of each group before its fault is raised.
  double encoder_timeout_s = 0.005;
  double drive_timeout_s = 0.020;
  double emg_timeout_s = 0.050;
  /// Older than this the operator's enable and reset count as released: a lost cable must not hold them,
  /// and both must be seen released before a press counts again.
  double operator_timeout_s = 0.5;

  double encoder_period_s = 0.001;
  double emg_period_s = 0.001;

  /// Range of a position, and its farthest way in one sensor period.
  double position_min_rad = boundOf("checks.position_min_rad").minimum;
  double position_max_rad = boundOf("checks.position_max_rad").maximum;
  double position_jump_rad = boundOf("checks.position_jump_rad").maximum;

  /// Frames of one message, one after another, that may fail by CRC, sequence or range before the fault of
  /// that kind is raised.
  int tolerated_bad_frames = 3;
};

/// A signal of a command that is the same in every frame.
struct Constant {
  std::string signal;
  double value = 0.0;  ///< in the DBC's unit
  std::string origin{};
};

/// A frame that is sent as it stands.
struct FixedFrame {
  std::string message;  ///< empty: that of the command
  std::vector<std::uint8_t> data;
  std::string origin{};
};

/// The frame that commands one drive, or all of them, and the frames by which it enters and leaves.
struct CommandMap {
  std::string message;
  std::vector<Binding> bindings;  ///< their `message` may be left empty
  Protection protection;          ///< its `message` may be left empty
  std::vector<Constant> constants{};
  std::vector<FixedFrame> enter{};  ///< repeated until the drive reports enabled
  std::vector<FixedFrame> leave{};  ///< repeated until it reports disabled
  std::vector<FixedFrame> clear{};  ///< when the operator presses reset while the drive is out
  double enter_period_s = 0.01;
  double enter_timeout_s = 0.5;
  double enter_time_s = 0.0;  ///< how long a drive that does not report is told to enter; 0: it reports
  /// CANopen node of a CiA 402 drive, which enters and leaves by its controlword; 0: another kind.
  int node = 0;
  std::string controlword{};  ///< signal of the message, with a node
  std::string origin{};
};

}  // namespace patella::can
