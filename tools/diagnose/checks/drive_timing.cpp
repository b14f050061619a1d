#include "tools/diagnose/checks/drive_timing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace patella::diagnose {
namespace {

constexpr double kLongestDelay_s = 0.05;
constexpr double kLongestLag_s = 0.2;
constexpr double kResolution_s = 1e-5;
constexpr std::array kLagGrid_s{0.0, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128};
constexpr double kDelayGrid_s = 0.002;

/// Measured and commanded torque of one joint on one stretch without a gap.
struct Stretch {
  double rate_Hz = 0.0;
  std::span<const double> measured_Nm;
  std::span<const double> commanded_Nm;
};

std::vector<Stretch> stretchesOf(std::span<const Recording> recordings, std::size_t joint) {
  std::vector<Stretch> stretches;
  for (const Recording& recording : recordings) {
    if (recording.is_static || recording.commanded_Nm[joint].empty()) {
      continue;
    }
    for (const Segment& segment : recording.segments) {
      const std::size_t count = segment.end - segment.first;
      stretches.push_back(
          {.rate_Hz = recording.rate_Hz,
           .measured_Nm = std::span(recording.torque_Nm[joint]).subspan(segment.first, count),
           .commanded_Nm = std::span(recording.commanded_Nm[joint]).subspan(segment.first, count)});
    }
  }
  return stretches;
}

struct Timing {
  double delay_s = 0.0;
  double lag_s = 0.0;
  double squares = std::numeric_limits<double>::infinity();
};

Timing judged(std::span<const Stretch> stretches, double delay_s, double lag_s) {
  Timing timing{.delay_s = std::clamp(delay_s, 0.0, kLongestDelay_s),
                .lag_s = std::clamp(lag_s, 0.0, kLongestLag_s),
                .squares = 0.0};
  for (const Stretch& s : stretches) {
    const std::vector<double> explained =
        delayedAndLagged(s.commanded_Nm, s.rate_Hz, timing.delay_s, timing.lag_s, s.measured_Nm.front());
    for (std::size_t i = 0; i < explained.size(); ++i) {
      const double error = s.measured_Nm[i] - explained[i];
      timing.squares += error * error;
    }
  }
  return timing;
}

Timing bestTiming(std::span<const Stretch> stretches) {
  Timing best;
  const auto consider = [&](double delay_s, double lag_s) {
    const Timing timing = judged(stretches, delay_s, lag_s);
    const bool better = timing.squares < best.squares;
    best = better ? timing : best;
    return better;
  };
  for (double delay_s = 0.0; delay_s < kLongestDelay_s; delay_s += kDelayGrid_s) {
    for (const double lag_s : kLagGrid_s) {
      consider(delay_s, lag_s);
    }
  }
  // The error is flat along delay + lag = constant, hence the diagonals.
  constexpr std::array<std::array<double, 2>, 8> kDirections{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}, {1, 1}, {-1, -1}}};
  for (double step_s = kDelayGrid_s; step_s > kResolution_s;) {
    const Timing centre = best;
    bool moved = false;
    for (const auto& [delay, lag] : kDirections) {
      moved = consider(centre.delay_s + step_s * delay, centre.lag_s + step_s * lag) || moved;
    }
    step_s = moved ? step_s : 0.5 * step_s;
  }
  return best;
}

}  // namespace

std::vector<double> delayedAndLagged(std::span<const double> commanded_Nm, double rate_Hz, double delay_s,
                                     double lag_s, double first_Nm) {
  const double samples = delay_s * rate_Hz;
  const double whole = std::floor(samples);
  // Over a step the delayed command changes once, after this share of it.
  const double share = samples - whole;
  const auto at = [&](std::ptrdiff_t index) {
    return index < 0 ? first_Nm : commanded_Nm[static_cast<std::size_t>(index)];
  };
  const auto late = static_cast<std::ptrdiff_t>(whole);
  const auto decay = [&](double steps) { return lag_s > 0.0 ? std::exp(-steps / (rate_Hz * lag_s)) : 0.0; };
  std::vector<double> torque_Nm(commanded_Nm.size(), first_Nm);
  for (std::size_t i = 0; i < torque_Nm.size(); ++i) {
    const auto now = static_cast<std::ptrdiff_t>(i) - late;
    if (lag_s <= 0.0) {
      torque_Nm[i] = at(share > 0.0 ? now - 1 : now);
    } else if (i > 0) {
      const double older = at(now - 2);
      const double newer = at(now - 1);
      const double middle = older + (torque_Nm[i - 1] - older) * decay(share);
      torque_Nm[i] = newer + (middle - newer) * decay(1.0 - share);
    }
  }
  return torque_Nm;
}

std::vector<DriveTiming> driveTiming(std::span<const Recording> recordings) {
  std::vector<DriveTiming> timings;
  for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
    const std::vector<Stretch> stretches = stretchesOf(recordings, joint);
    double squares = 0.0;
    double before = 0.0;
    for (const Stretch& s : stretches) {
      for (std::size_t i = 0; i < s.measured_Nm.size(); ++i) {
        squares += s.measured_Nm[i] * s.measured_Nm[i];
        const double error = s.measured_Nm[i] - s.commanded_Nm[i];
        before += error * error;
      }
    }
    if (!(squares > 0.0)) {
      continue;
    }
    const Timing best = bestTiming(stretches);
    timings.push_back({.joint = static_cast<int>(joint),
                       .delay_s = best.delay_s,
                       .lag_s = best.lag_s,
                       .relative_error_before = std::sqrt(before / squares),
                       .relative_error_after = std::sqrt(best.squares / squares)});
  }
  return timings;
}

}  // namespace patella::diagnose
