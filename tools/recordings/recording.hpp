// A measured run as diagnosis works on it: a uniform time base, SI units, the loop's angles.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.hpp"

namespace patella::diagnose {

/// How a torque sample relates to the position sample of the same row.
enum class TorqueTiming {
  kHeld,     ///< commanded at the sample and held until the next: half of it and half of the one before acted
  kSampled,  ///< what acted at the instant of the sample
  kBefore,   ///< what acted from the sample before until this one: a drive's reply to its next command
};

/// "held", "sampled", "before": in the order of TorqueTiming.
const std::vector<std::string>& torqueTimingNames();
/// Of one of those names. Throws std::invalid_argument for another.
TorqueTiming torqueTimingNamed(std::string_view name);

/// Rows first … end−1 of a recording that follow each other without a gap.
struct Segment {
  std::size_t first = 0;
  std::size_t end = 0;
  std::size_t lead = 0;  ///< rows at its beginning that only tell in what state the others find the machine
};

struct Recording {
  std::string name;    ///< file it came from
  std::string sha256;  ///< of that file
  double rate_Hz = 0.0;
  int joints = 0;
  TorqueTiming torque_timing = TorqueTiming::kHeld;
  bool torque_timing_assumed = false;  ///< neither the file nor its reader says
  /// A table of postures at rest: rows have no order in time, rates and accelerations are zero.
  bool is_static = false;
  std::vector<double> time_s;  ///< uniform in each segment: its first + i / rate
  std::array<std::vector<double>, kMaxJoints> position_rad;
  /// As the loop had it, measured or derived; empty where the recording does not tell. Diagnosis derives its
  /// own.
  std::array<std::vector<double>, kMaxJoints> velocity_rad_s;
  std::array<std::vector<double>, kMaxJoints> torque_Nm;
  /// Commanded torque where the recording has it beside a measured one; empty otherwise.
  std::array<std::vector<double>, kMaxJoints> commanded_Nm;
  /// Unknown acceleration f_u as a simulated rig publishes it; empty unless asked for.
  std::array<std::vector<double>, kMaxJoints> unknown_rad_s2;
  /// EMG activation 0…1; empty where the recording has no EMG.
  std::array<std::vector<double>, kMaxEmgChannels> activation;
  std::vector<Segment> segments;      ///< at least one; a loss of more than a few samples ends a segment
  std::vector<std::string> warnings;  ///< what was repaired on the way: repeated stamps, losses, clipping
  std::size_t rows() const noexcept { return time_s.size(); }
};

}  // namespace patella::diagnose
