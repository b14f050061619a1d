#include "tools/recordings/repeated_samples.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tools/convert/time_base.hpp"
#include "tools/recordings/reading_limits.hpp"
#include "tools/recordings/sample_clock.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

using convert::Interpolation;
using convert::TimeBase;
using namespace repeated_samples;

constexpr double kRounding_s = 1e-9;

enum class Kind { kPosition, kTorque, kOther };

struct Signal {
  std::vector<double>* values = nullptr;
  Kind kind = Kind::kOther;
  std::string name;
  double period_rows = 1.0;  ///< from one new value to the next
  bool repeated() const noexcept { return period_rows > 1.0; }
  bool averaged() const noexcept { return kind == Kind::kTorque && !repeated(); }
};

std::vector<Signal> signalsOf(Recording& recording) {
  std::vector<Signal> signals;
  const auto add = [&](auto& group, Kind kind, const char* stem) {
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (!group[i].empty()) {
        signals.push_back({.values = &group[i], .kind = kind, .name = fmt::format("{} {}", stem, i + 1)});
      }
    }
  };
  add(recording.position_rad, Kind::kPosition, "position of joint");
  add(recording.velocity_rad_s, Kind::kOther, "velocity of joint");
  add(recording.torque_Nm, Kind::kTorque, "torque of joint");
  add(recording.commanded_Nm, Kind::kTorque, "commanded torque of joint");
  add(recording.unknown_rad_s2, Kind::kOther, "true f_u of joint");
  add(recording.activation, Kind::kOther, "activation of EMG channel");
  return signals;
}

/// Rows of a segment whose value differs from that of the row before.
std::vector<std::size_t> changesIn(const std::vector<double>& values, const Segment& segment) {
  std::vector<std::size_t> rows;
  for (std::size_t row = segment.first + 1; row < segment.end; ++row) {
    if (values[row] != values[row - 1]) {
      rows.push_back(row);
    }
  }
  return rows;
}

/// Rows from one change to the next, for neighbouring changes of which neither is within the resolution.
std::vector<double> rowsBetweenChanges(const std::vector<double>& values,
                                       const std::vector<Segment>& segments) {
  const auto step = [&](std::size_t row) { return std::abs(values[row] - values[row - 1]); };
  double resolution = std::numeric_limits<double>::infinity();
  for (const Segment& segment : segments) {
    for (const std::size_t row : changesIn(values, segment)) {
      resolution = std::min(resolution, step(row));
    }
  }
  std::vector<double> between;
  for (const Segment& segment : segments) {
    const std::vector<std::size_t> changes = changesIn(values, segment);
    for (std::size_t i = 1; i < changes.size(); ++i) {
      if (std::min(step(changes[i - 1]), step(changes[i])) > kResolutions * resolution) {
        between.push_back(static_cast<double>(changes[i] - changes[i - 1]));
      }
    }
  }
  return between;
}

/// Rows from one new value to the next; 1 where neighbouring rows have values of their own, or where values
/// come at no regular pace.
double periodOf(const std::vector<double>& values, const std::vector<Segment>& segments) {
  std::vector<double> between = rowsBetweenChanges(values, segments);
  if (between.size() < kFewest) {
    return 1.0;
  }
  const auto count = static_cast<double>(between.size());
  const auto at_once = static_cast<double>(std::count(between.begin(), between.end(), 1.0));
  const double median = offline::median(between);
  if (median < 2.0 || at_once > kMostAtOnce * count) {
    return 1.0;
  }
  std::erase_if(between,
                [&](double rows) { return std::abs(rows - median) > std::max(1.0, kPace * median); });
  if (static_cast<double>(between.size()) < kRegular * count) {
    return 1.0;
  }
  return std::accumulate(between.begin(), between.end(), 0.0) / static_cast<double>(between.size());
}

/// Rows in which a sample came: at each change, and each period before and after it while the value stood
/// still.
std::vector<std::size_t> newRows(const std::vector<std::size_t>& changes, double period_rows,
                                 const Segment& segment) {
  std::vector<std::size_t> rows;
  double previous = static_cast<double>(segment.first) - 0.5 * period_rows;
  for (const std::size_t change : changes) {
    std::vector<std::size_t> still;
    const auto end = static_cast<double>(change);
    for (double row = end - period_rows; row > previous + 0.5 * period_rows; row -= period_rows) {
      still.push_back(static_cast<std::size_t>(std::round(row)));
    }
    rows.insert(rows.end(), still.rbegin(), still.rend());
    rows.push_back(change);
    previous = end;
  }
  for (double row = previous + period_rows; row < static_cast<double>(segment.end); row += period_rows) {
    rows.push_back(static_cast<std::size_t>(row));
  }
  return rows;
}

/// Instants at which a signal was sampled: where its value is new, or every row where it is not repeated.
TimeBase samplesOf(const Signal& signal, const Segment& segment, const Recording& recording) {
  TimeBase base;
  const std::vector<std::size_t> changes =
      signal.repeated() ? changesIn(*signal.values, segment) : std::vector<std::size_t>{};
  if (changes.empty()) {
    base.row.resize(segment.end - segment.first);
    std::iota(base.row.begin(), base.row.end(), segment.first);
  } else {
    base.row = newRows(changes, signal.period_rows, segment);
  }
  for (const std::size_t row : base.row) {
    base.time_s.push_back(recording.time_s[row]);
  }
  if (changes.empty()) {
    return base;
  }
  const double rate_Hz = recording.rate_Hz / signal.period_rows;
  if (const auto ticks = clockTicks(base.time_s, rate_Hz)) {
    const double start_s = base.time_s.front();
    for (std::size_t i = 0; i < ticks->size(); ++i) {
      base.time_s[i] = start_s + static_cast<double>((*ticks)[i]) / rate_Hz;
    }
  }
  return base;
}

/// Mean of the values from each instant to the next.
std::vector<double> meansUntilNext(const std::vector<double>& values, const Segment& segment,
                                   const Recording& recording, const std::vector<double>& grid_s,
                                   double period_s) {
  std::vector<double> means;
  std::size_t row = segment.first;
  for (const double from_s : grid_s) {
    while (row + 1 < segment.end && recording.time_s[row] < from_s - kRounding_s) {
      ++row;
    }
    double sum = values[row];
    std::size_t next = row + 1;
    for (; next < segment.end && recording.time_s[next] < from_s + period_s - kRounding_s; ++next) {
      sum += values[next];
    }
    means.push_back(sum / static_cast<double>(next - row));
  }
  return means;
}

/// Instants at which `slowest` was sampled in a segment, as far as the samples of all signals and the means
/// of `end_s` reach.
std::vector<double> instantsOf(const TimeBase& slowest, const std::vector<TimeBase>& samples, double rate_Hz,
                               double end_s) {
  double from_s = 0.0, to_s = end_s;
  for (const TimeBase& base : samples) {
    from_s = std::max(from_s, base.time_s.front() - kRounding_s);
    to_s = std::min(to_s, base.time_s.back() + kRounding_s);
  }
  std::vector<double> instants_s = convert::uniformGrid(slowest, rate_Hz);
  std::erase_if(instants_s, [&](double instant_s) { return instant_s < from_s || instant_s > to_s; });
  return instants_s;
}

/// The slowest of the repeated ones; none where nothing is repeated.
const Signal* slowestOf(const std::vector<Signal>& signals) {
  const Signal* slowest = nullptr;
  for (const Signal& signal : signals) {
    if (signal.repeated() && (slowest == nullptr || signal.period_rows > slowest->period_rows)) {
      slowest = &signal;
    }
  }
  return slowest;
}

std::string described(const std::vector<Signal>& signals, double rate_Hz) {
  std::string text;
  for (const Signal& signal : signals) {
    if (signal.repeated()) {
      text += fmt::format("{}{} comes at {:.4g} Hz", text.empty() ? "" : ", ", signal.name,
                          rate_Hz / signal.period_rows);
    }
  }
  return text;
}

}  // namespace

void readWhereNew(Recording& recording) {
  std::vector<Signal> signals = signalsOf(recording);
  for (Signal& signal : signals) {
    if (signal.kind != Kind::kOther) {
      const double period_rows = periodOf(*signal.values, recording.segments);
      // A torque that steps so slowly is a command that was held, and acted as it stands.
      const bool command =
          signal.kind == Kind::kTorque && recording.rate_Hz < kSlowestTorque_Hz * period_rows;
      signal.period_rows = command ? 1.0 : period_rows;
    }
  }
  const Signal* slowest = slowestOf(signals);
  if (slowest == nullptr) {
    return;
  }
  const double rate_Hz = recording.rate_Hz / slowest->period_rows;
  const bool averages = std::any_of(signals.begin(), signals.end(), std::mem_fn(&Signal::averaged));
  std::vector<double> time_s;
  std::vector<Segment> segments;
  std::vector<std::vector<double>> values(signals.size());
  for (const Segment& segment : recording.segments) {
    std::vector<TimeBase> samples;
    for (const Signal& signal : signals) {
      samples.push_back(samplesOf(signal, segment, recording));
    }
    const auto reference = static_cast<std::size_t>(slowest - signals.data());
    const double last_s = recording.time_s[segment.end - 1];
    const double end_s = averages ? last_s + 1.0 / recording.rate_Hz - 1.0 / rate_Hz + kRounding_s : last_s;
    const std::vector<double> grid_s = instantsOf(samples[reference], samples, rate_Hz, end_s);
    if (grid_s.empty()) {
      continue;  // too short to hold a sample of every signal
    }
    segments.push_back({.first = time_s.size(), .end = time_s.size() + grid_s.size()});
    time_s.insert(time_s.end(), grid_s.begin(), grid_s.end());
    for (std::size_t i = 0; i < signals.size(); ++i) {
      const Signal& signal = signals[i];
      const std::vector<double> part =
          signal.averaged() ? meansUntilNext(*signal.values, segment, recording, grid_s, 1.0 / rate_Hz)
                            : convert::resample(samples[i], *signal.values, grid_s,
                                                signal.kind == Kind::kPosition ? Interpolation::kCubic
                                                                               : Interpolation::kLinear);
      values[i].insert(values[i].end(), part.begin(), part.end());
    }
  }
  recording.warnings.push_back(
      fmt::format("{}, in rows of {:.4g} Hz: read at {:.4g} Hz, where values are new",
                  described(signals, recording.rate_Hz), recording.rate_Hz, rate_Hz));
  const bool keeps_torque = std::any_of(signals.begin(), signals.end(), [](const Signal& signal) {
    return signal.kind == Kind::kTorque && signal.repeated();
  });
  if (!keeps_torque) {
    recording.torque_timing = TorqueTiming::kHeld;
    recording.torque_timing_assumed = false;
  }
  recording.rate_Hz = rate_Hz;
  recording.time_s = std::move(time_s);
  recording.segments = std::move(segments);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    *signals[i].values = std::move(values[i]);
  }
}

}  // namespace patella::diagnose
