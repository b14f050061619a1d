// Which signal of which message feeds which input: what configuration fills in.
#pragma once

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

/// The frame that commands the drives.
struct CommandMap {
  std::string message;
  std::vector<Binding> bindings;  ///< their `message` may be left empty
  Protection protection;          ///< its `message` may be left empty
};

}  // namespace patella::can
