#include "tools/recordings/instants.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "firmware_app/files/file_error.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

constexpr double kRoundingOfRate = 0.002;

/// Mean of the steps between which no sample was lost: those about as long as the median.
double ordinaryStep_s(const std::vector<double>& stamps_s) {
  std::vector<double> steps(stamps_s.size());
  std::adjacent_difference(stamps_s.begin(), stamps_s.end(), steps.begin());
  steps.erase(steps.begin());
  const double median_s = offline::median(steps);
  std::erase_if(steps, [=](double step) { return std::abs(step - median_s) > 0.5 * median_s; });
  return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
}

/// Samples by elapsed time, lost ones counted, in stretches against whose length jitter is little.
double meanRate(const std::vector<double>& stamps_s) {
  constexpr std::size_t kLength = 50;
  const double step_s = ordinaryStep_s(stamps_s);
  double samples = 0.0, elapsed_s = 0.0;
  for (std::size_t i = kLength; i < stamps_s.size(); i += kLength) {
    const double stretch_s = stamps_s[i] - stamps_s[i - kLength];
    const double count = std::round(stretch_s / step_s);
    if (count < 2.0 * kLength) {
      samples += count;
      elapsed_s += stretch_s;
    }
  }
  return samples > 0.0 ? samples / elapsed_s : 1.0 / step_s;
}

}  // namespace

Instants instantsOf(const RawRecording& raw) {
  Instants instants;
  for (std::size_t row = 0; row < raw.rows(); ++row) {
    const double stamp_s = raw.stamp_s[row];
    if (!instants.stamp_s.empty() && stamp_s <= instants.stamp_s.back()) {
      if (stamp_s < instants.stamp_s.back()) {
        throw app::FileError(
            fmt::format("{}: time {} s comes after {} s in the row before, expected it to increase",
                        placeOf(raw, row), stamp_s, instants.stamp_s.back()));
      }
      instants.rows.back().end = row + 1;
      continue;
    }
    instants.stamp_s.push_back(stamp_s);
    instants.rows.push_back({.first = row, .end = row + 1});
  }
  return instants;
}

double rateOf(const RawRecording& raw, const Instants& instants) {
  const double rate_Hz = raw.rate_Hz.value_or(meanRate(instants.stamp_s));
  const double whole_Hz = std::round(rate_Hz);
  return std::abs(rate_Hz - whole_Hz) <= kRoundingOfRate * rate_Hz ? whole_Hz : rate_Hz;
}

std::vector<double> averaged(const std::vector<double>& values, const Instants& instants) {
  std::vector<double> result;
  result.reserve(instants.rows.size());
  for (const Segment& rows : instants.rows) {
    const double sum = std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(rows.first),
                                       values.begin() + static_cast<std::ptrdiff_t>(rows.end), 0.0);
    result.push_back(sum / static_cast<double>(rows.end - rows.first));
  }
  return result;
}

}  // namespace patella::diagnose
