#include "tools/recordings/uniform_recording.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "firmware_app/files/file_error.hpp"
#include "tools/convert/time_base.hpp"
#include "tools/recordings/instants.hpp"
#include "tools/recordings/integrated_position.hpp"
#include "tools/recordings/outliers.hpp"
#include "tools/recordings/reading_limits.hpp"
#include "tools/recordings/recorded_emg.hpp"
#include "tools/recordings/repeated_samples.hpp"
#include "tools/recordings/sample_clock.hpp"
#include "tools/recordings/time_units.hpp"

namespace patella::diagnose {
namespace {

using app::FileError;
using convert::Interpolation;
using convert::TimeBase;

/// Share of the rows: with more of them without a value, it is the recording that is broken and not the bus.
constexpr double kMostIncomplete = 0.1;

/// Name of the first signal without a value in the row, or nothing.
std::string missingIn(const RawRecording& raw, std::size_t row) {
  std::string missing;
  if (!raw.stamp_s.empty() && !std::isfinite(raw.stamp_s[row])) {
    missing = "time";
  }
  RawRecording::forEachSignal(raw, [&](const std::string& name, const std::vector<double>& values) {
    if (missing.empty() && !std::isfinite(values[row])) {
      missing = name;
    }
  });
  return missing;
}

bool isComplete(const RawRecording& raw, std::size_t row) {
  bool complete = raw.stamp_s.empty() || std::isfinite(raw.stamp_s[row]);
  RawRecording::forEachSignal(raw, [&](const std::string&, const std::vector<double>& values) {
    complete = complete && std::isfinite(values[row]);
  });
  return complete;
}

/// Takes out the rows that lack a value: those at the ends, and lost samples between.
void keepCompleteRows(RawRecording& raw) {
  std::vector<std::size_t> complete;
  std::size_t first_missing = 0;
  for (std::size_t row = 0; row < raw.rows(); ++row) {
    if (isComplete(raw, row)) {
      complete.push_back(row);
    } else if (!complete.empty() && first_missing == 0) {
      first_missing = row;
    }
  }
  if (!complete.empty() && first_missing != 0 && first_missing < complete.back()) {
    const std::size_t between = complete.back() - complete.front() + 1;
    const std::size_t lost = between - complete.size();
    if (static_cast<double>(lost) > kMostIncomplete * static_cast<double>(between)) {
      throw FileError(
          fmt::format("{}: {} has no value, as in {} of {} rows, expected at most {:.0f} % of rows without",
                      placeOf(raw, first_missing), missingIn(raw, first_missing), lost, between,
                      100.0 * kMostIncomplete));
    }
    raw.warnings.push_back(fmt::format("{} rows without a value were taken as lost, the first at {}", lost,
                                       placeOf(raw, first_missing)));
  }
  keepRows(raw, complete);
}

void requireRows(const RawRecording& raw, std::size_t rows, std::size_t fewest) {
  if (rows < fewest) {
    throw FileError(fmt::format("{}: {} complete rows, expected at least {}", raw.name, rows, fewest));
  }
}

/// Instants first … end−1 between two gaps, and the uniform ones that take their place.
struct Stretch {
  TimeBase base;     ///< by the stamps
  TimeBase clocked;  ///< by the ticks of a regular clock; empty where the stamps tell of none
  std::vector<double> grid_s;
  double rate_Hz = 0.0;
};

Stretch stretchOf(const Instants& instants, std::size_t first, std::size_t end, double rate_Hz) {
  Stretch stretch{.base = {}, .clocked = {}, .grid_s = {}, .rate_Hz = rate_Hz};
  for (std::size_t i = first; i < end; ++i) {
    stretch.base.time_s.push_back(instants.stamp_s[i]);
    stretch.base.row.push_back(i);
  }
  const double start_s = stretch.base.time_s.front();
  const auto at = [&](std::size_t tick) { return start_s + static_cast<double>(tick) / rate_Hz; };
  const auto ticks = clockTicks(stretch.base.time_s, rate_Hz);
  if (!ticks) {
    return stretch;
  }
  stretch.clocked.row = stretch.base.row;
  for (const std::size_t tick : *ticks) {
    stretch.clocked.time_s.push_back(at(tick));
  }
  for (std::size_t tick = 0; tick <= ticks->back(); ++tick) {
    stretch.grid_s.push_back(at(tick));
  }
  return stretch;
}

std::vector<Stretch> stretchesOf(const Instants& instants, double rate_Hz,
                                 std::vector<std::string>& warnings) {
  const double longest_s = gaps::longestBridge_s(1.0 / rate_Hz);
  std::vector<Stretch> stretches;
  std::size_t first = 0;
  std::size_t bridged = 0;
  std::size_t gap_count = 0;
  double widest_s = 0.0;
  double widest_at_s = 0.0;
  for (std::size_t i = 1; i <= instants.stamp_s.size(); ++i) {
    const bool last = i == instants.stamp_s.size();
    const double step_s = last ? 0.0 : instants.stamp_s[i] - instants.stamp_s[i - 1];
    if (!last && step_s <= longest_s) {
      bridged += static_cast<std::size_t>(std::max(0.0, std::round(step_s * rate_Hz) - 1.0));
      continue;
    }
    if (i - first > 1) {
      stretches.push_back(stretchOf(instants, first, i, rate_Hz));
    }
    first = i;
    gap_count += last ? 0 : 1;
    if (step_s > widest_s) {
      widest_s = step_s;
      widest_at_s = instants.stamp_s[i - 1];
    }
  }
  if (bridged > 0) {
    warnings.push_back(fmt::format("{} lost samples were interpolated", bridged));
  }
  if (gap_count > 0) {
    warnings.push_back(
        fmt::format("{} {} of up to {:.3g} s, the longest at {:.4g} s: taken as separate stretches",
                    gap_count, gap_count == 1 ? "gap" : "gaps", widest_s, widest_at_s));
  }
  return stretches;
}

/// Whether samples were taken at their stamps, and not by a regular clock from which they only arrived late.
/// If they were, what each deviates from a smooth motion is the velocity times what its stamp deviates from
/// the clock.
class StampsTrial {
 public:
  void add(const std::vector<double>& values, const Stretch& stretch) {
    const auto& clock_s = stretch.clocked.time_s;
    const auto& stamp_s = stretch.base.time_s;
    const auto& row = stretch.base.row;
    for (std::size_t i = 1; i + 1 < clock_s.size(); ++i) {
      const double step_s = clock_s[i] - clock_s[i - 1];
      const bool lost = std::abs(clock_s[i + 1] - clock_s[i] - step_s) > 0.5 * step_s;
      if (!lost) {
        const double before = values[row[i - 1]], here = values[row[i]], after = values[row[i + 1]];
        const double velocity = (after - before) / (clock_s[i + 1] - clock_s[i - 1]);
        const auto late = [&](std::size_t k) { return stamp_s[k] - clock_s[k]; };
        const double expected = velocity * (late(i + 1) - 2.0 * late(i) + late(i - 1));
        product_ += expected * (after - 2.0 * here + before);
        square_ += expected * expected;
      }
    }
  }
  bool passed() const noexcept { return product_ > 0.5 * square_; }

 private:
  double product_ = 0.0;
  double square_ = 0.0;
};

void trustStampsOrClock(const RawRecording& raw, const Instants& instants, std::vector<Stretch>& stretches) {
  StampsTrial trial;
  for (std::size_t j = 0; j < static_cast<std::size_t>(raw.joints); ++j) {
    const std::vector<double> position = averaged(raw.position_rad[j], instants);
    for (const Stretch& stretch : stretches) {
      trial.add(position, stretch);
    }
  }
  for (Stretch& stretch : stretches) {
    if (!stretch.clocked.time_s.empty() && !trial.passed()) {
      stretch.base = stretch.clocked;
    } else {
      stretch.grid_s = convert::uniformGrid(stretch.base, stretch.rate_Hz);
    }
  }
}

/// Joins `values`, one for each instant, of all stretches one after the other.
std::vector<double> resampled(const std::vector<double>& values, const std::vector<Stretch>& stretches,
                              Interpolation method) {
  std::vector<double> result;
  for (const Stretch& stretch : stretches) {
    const std::vector<double> part = convert::resample(stretch.base, values, stretch.grid_s, method);
    result.insert(result.end(), part.begin(), part.end());
  }
  return result;
}

void fillEmg(const RawRecording& raw, const Instants& instants, const std::vector<Stretch>& stretches,
             Recording& recording) {
  EmgChannels emg_mV;
  bool raw_emg = false;
  for (std::size_t c = 0; c < kMaxEmgChannels; ++c) {
    if (!raw.activation[c].empty() && !silent(raw.activation[c])) {
      recording.activation[c] =
          resampled(averaged(raw.activation[c], instants), stretches, Interpolation::kLinear);
    }
    if (!raw.emg_mV[c].empty()) {
      emg_mV[c] = resampled(averaged(raw.emg_mV[c], instants), stretches, Interpolation::kLinear);
      raw_emg = raw_emg || !silent(emg_mV[c]);
    }
  }
  if (raw_emg) {
    recording.activation = activationOf(emg_mV, recording);
  }
}

/// Each signal is let go once it has been read: an hour of them is hundreds of megabytes.
void fillJoints(RawRecording& raw, const Instants& instants, const std::vector<Stretch>& stretches,
                Recording& recording) {
  const auto taken = [&](std::vector<double>& values) {
    return averaged(std::exchange(values, {}), instants);
  };
  // Of a held torque, too: its samples are what was asked for at their stamps, and whoever reads them makes
  // of them what acted. Rows of the grid that repeated the sample before them would be late twice.
  constexpr Interpolation kOfTorque = Interpolation::kLinear;
  for (std::size_t j = 0; j < static_cast<std::size_t>(raw.joints); ++j) {
    recording.torque_Nm[j] = resampled(taken(raw.torque_Nm[j]), stretches, kOfTorque);
    recording.position_rad[j] = resampled(taken(raw.position_rad[j]), stretches, Interpolation::kCubic);
    if (!raw.velocity_rad_s[j].empty()) {
      recording.velocity_rad_s[j] = resampled(taken(raw.velocity_rad_s[j]), stretches, Interpolation::kCubic);
    }
    if (!raw.commanded_Nm[j].empty()) {
      recording.commanded_Nm[j] = resampled(taken(raw.commanded_Nm[j]), stretches, kOfTorque);
    }
    if (!raw.unknown_rad_s2[j].empty()) {
      recording.unknown_rad_s2[j] =
          resampled(taken(raw.unknown_rad_s2[j]), stretches, Interpolation::kLinear);
    }
  }
}

/// Rows that may be relied on, in seconds from the first of them.
Instants judgedInstants(RawRecording& raw) {
  Instants instants = instantsOf(raw);
  requireRows(raw, instants.stamp_s.size(), kFewestRows);
  if (!raw.rate_Hz) {
    requireSeconds(raw, instants.stamp_s);
  }
  const std::size_t rows = raw.rows();
  dropOutliers(raw);
  if (raw.rows() < rows) {
    instants = instantsOf(raw);
    requireRows(raw, instants.stamp_s.size(), kFewestRows);
  }
  integrateVelocity(raw);
  const double start_s = instants.stamp_s.front();
  for (double& stamp_s : instants.stamp_s) {
    stamp_s -= start_s;
  }
  return instants;
}

Recording makePostures(const RawRecording& raw, Recording recording) {
  const Segment rows{.first = 0, .end = raw.rows()};
  requireRows(raw, rows.end, kFewestPostures);
  for (std::size_t row = 0; row < raw.rows(); ++row) {
    if (const std::string missing = missingIn(raw, row); !missing.empty()) {
      throw FileError(placeOf(raw, row) + ": " + missing + " has no value, expected one in every posture");
    }
  }
  recording.rate_Hz = 1.0;
  for (std::size_t i = 0; i < rows.end; ++i) {
    recording.time_s.push_back(static_cast<double>(i));
  }
  recording.position_rad = raw.position_rad;
  recording.torque_Nm = raw.torque_Nm;
  recording.commanded_Nm = raw.commanded_Nm;
  recording.activation = raw.activation;
  recording.segments = {rows};
  return recording;
}

}  // namespace

Recording makeUniform(RawRecording raw) {
  Recording recording;
  recording.name = raw.name;
  recording.joints = raw.joints;
  recording.torque_timing = raw.torque_timing;
  recording.torque_timing_assumed = raw.torque_timing_assumed;
  recording.is_static = raw.is_static;
  if (raw.is_static) {
    recording.warnings = raw.warnings;
    return makePostures(raw, std::move(recording));
  }
  keepCompleteRows(raw);
  requireRows(raw, raw.rows(), kFewestRows);
  const Instants instants = judgedInstants(raw);
  recording.warnings = raw.warnings;
  if (const std::size_t repeated = raw.rows() - instants.stamp_s.size(); repeated > 0) {
    recording.warnings.push_back(
        fmt::format("{} rows with the time stamp of the row before were averaged with it", repeated));
  }
  recording.rate_Hz = rateOf(raw, instants);
  std::vector<Stretch> stretches = stretchesOf(instants, recording.rate_Hz, recording.warnings);
  trustStampsOrClock(raw, instants, stretches);
  for (const Stretch& stretch : stretches) {
    recording.segments.push_back(
        {.first = recording.rows(), .end = recording.rows() + stretch.grid_s.size()});
    recording.time_s.insert(recording.time_s.end(), stretch.grid_s.begin(), stretch.grid_s.end());
  }
  fillJoints(raw, instants, stretches, recording);
  fillEmg(raw, instants, stretches, recording);
  readWhereNew(recording);
  requireRows(raw, recording.rows(), kFewestRows);
  return recording;
}

}  // namespace patella::diagnose
