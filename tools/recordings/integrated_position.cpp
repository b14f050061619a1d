#include "tools/recordings/integrated_position.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware_app/files/file_error.hpp"
#include "tools/recordings/reading_limits.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

void requireNoGap(const RawRecording& recording, std::size_t joint) {
  std::vector<double> steps_s;
  for (std::size_t row = 1; row < recording.rows(); ++row) {
    steps_s.push_back(recording.stamp_s[row] - recording.stamp_s[row - 1]);
  }
  const double longest_s = gaps::longestBridge_s(offline::median(steps_s));
  const auto gap = std::find_if(steps_s.begin(), steps_s.end(), [=](double s) { return s > longest_s; });
  if (gap != steps_s.end()) {
    const auto row = static_cast<std::size_t>(gap - steps_s.begin()) + 1;
    throw app::FileError(
        fmt::format("{}: a gap of {:.3g} s before this row, after which the velocity of joint {} does not "
                    "tell its position; "
                    "expected a recording without gaps, or a position",
                    placeOf(recording, row), *gap, joint + 1));
  }
}

}  // namespace

void integrateVelocity(RawRecording& recording) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    if (!recording.start_rad[j]) {
      continue;
    }
    requireNoGap(recording, j);
    const std::vector<double>& velocity = recording.velocity_rad_s[j];
    std::vector<double>& position = recording.position_rad[j];
    position.assign(1, *recording.start_rad[j]);
    for (std::size_t row = 1; row < recording.rows(); ++row) {
      const double step_s = recording.stamp_s[row] - recording.stamp_s[row - 1];
      position.push_back(position.back() + 0.5 * step_s * (velocity[row - 1] + velocity[row]));
    }
    recording.warnings.push_back(
        fmt::format("the position of joint {} is the integral of its velocity from {:.4g}: a drift of the "
                    "velocity is a drift of the position",
                    j + 1, *recording.start_rad[j]));
  }
}

}  // namespace patella::diagnose
