// Rows of a recording as they came: in SI units and the loop's angles, on the time base of whoever recorded
// them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

struct RawRecording {
  std::string name;
  int joints = 0;
  TorqueTiming torque_timing = TorqueTiming::kHeld;
  bool torque_timing_assumed = false;
  bool is_static = false;
  /// Rate of the recording's own clock; where it is absent, the stamps tell it.
  std::optional<double> rate_Hz;
  std::string time_name = "t_s";  ///< of the column of stamps, for messages
  std::vector<double> stamp_s;    ///< empty for a table of postures
  /// Line of the file at which each row stands, for messages; empty where rows are no lines.
  std::vector<std::size_t> line;
  /// As in Recording; a cell that held nothing is NaN.
  std::array<std::vector<double>, kMaxJoints> position_rad;
  /// Where the integral of the velocity begins that takes the place of a position; else nothing.
  std::array<std::optional<double>, kMaxJoints> start_rad;
  std::array<std::vector<double>, kMaxJoints> velocity_rad_s;
  std::array<std::vector<double>, kMaxJoints> torque_Nm;
  std::array<std::vector<double>, kMaxJoints> commanded_Nm;
  std::array<std::vector<double>, kMaxJoints> unknown_rad_s2;
  std::array<std::vector<double>, kMaxEmgChannels> activation;
  std::array<std::vector<double>, kMaxEmgChannels> emg_mV;  ///< raw; empty where absent
  std::vector<std::string> warnings;
  /// "the file is cut off, and was read up to 3.2 s"; empty for a whole one. A warning has it, too.
  std::string cut_off;

  std::size_t rows() const noexcept { return stamp_s.empty() ? position_rad[0].size() : stamp_s.size(); }
  /// Calls `visit(name, values)` for every signal that the recording has, in a fixed order.
  template <typename Self, typename Visitor>
  static void forEachSignal(Self& recording, Visitor&& visit) {
    const auto group = [&](auto& signals, const char* stem) {
      for (std::size_t i = 0; i < signals.size(); ++i) {
        if (!signals[i].empty()) {
          visit(std::string(stem) + " " + std::to_string(i + 1), signals[i]);
        }
      }
    };
    group(recording.position_rad, "position of joint");
    group(recording.velocity_rad_s, "velocity of joint");
    group(recording.torque_Nm, "torque of joint");
    group(recording.commanded_Nm, "commanded torque of joint");
    group(recording.unknown_rad_s2, "true f_u of joint");
    group(recording.activation, "activation of EMG channel");
    group(recording.emg_mV, "EMG channel");
  }
};

/// Where a row stands, for messages: "run.csv:12", or "frames.log: sample 11".
std::string placeOf(const RawRecording& recording, std::size_t row);

/// Keeps the rows whose numbers are in `rows`, which increase.
void keepRows(RawRecording& recording, std::span<const std::size_t> rows);

}  // namespace patella::diagnose
