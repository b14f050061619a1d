#include "tools/diagnose/regression/excerpts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace patella::diagnose {
namespace {

std::size_t rowsOf(const std::vector<Segment>& segments) {
  return std::accumulate(segments.begin(), segments.end(), std::size_t{0},
                         [](std::size_t sum, const Segment& s) { return sum + (s.end - s.first); });
}

double length_s(const Recording& recording) {
  return recording.is_static ? 0.0 : static_cast<double>(rowsOf(recording.segments)) / recording.rate_Hz;
}

// The length above which recordings are cut, so that together they have `most_s`.
double longest_s(const std::vector<Recording>& recordings, double most_s) {
  std::vector<double> lengths;
  for (const Recording& recording : recordings) {
    lengths.push_back(length_s(recording));
  }
  std::sort(lengths.begin(), lengths.end());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double share_s = most_s / static_cast<double>(lengths.size() - i);
    if (lengths[i] > share_s) {
      return share_s;
    }
    most_s -= lengths[i];
  }
  return std::numeric_limits<double>::infinity();
}

// Rows of evenly spread excerpts, `kept` of each `period` rows, counted along the segments.
std::vector<Segment> excerptsOf(const std::vector<Segment>& segments, double kept, double period) {
  std::vector<Segment> excerpts;
  double before = 0.0;  // rows of the segments so far
  for (const Segment& segment : segments) {
    const auto rows = static_cast<double>(segment.end - segment.first);
    const double lead = 0.5 * (period - kept);
    for (double k = std::floor(before / period); k * period < before + rows; k += 1.0) {
      const double from = std::clamp(k * period + lead - before, 0.0, rows);
      const double to = std::clamp(k * period + lead + kept - before, 0.0, rows);
      if (std::floor(to) > std::ceil(from)) {
        excerpts.push_back({.first = segment.first + static_cast<std::size_t>(std::ceil(from)),
                            .end = segment.first + static_cast<std::size_t>(std::floor(to))});
      }
    }
    before += rows;
  }
  return excerpts;
}

void keep(const std::vector<Segment>& excerpts, std::vector<double>& values) {
  if (values.empty()) {
    return;
  }
  std::vector<double> kept;
  kept.reserve(rowsOf(excerpts));
  for (const Segment& excerpt : excerpts) {
    kept.insert(kept.end(), values.begin() + static_cast<std::ptrdiff_t>(excerpt.first),
                values.begin() + static_cast<std::ptrdiff_t>(excerpt.end));
  }
  values = std::move(kept);
}

void cut(Recording& recording, double most_s) {
  const double whole_s = length_s(recording);
  const double count = std::max(1.0, std::floor(most_s / length::kExcerpt_s));
  const double kept = most_s / count * recording.rate_Hz;
  const std::vector<Segment> excerpts =
      excerptsOf(recording.segments, kept, whole_s / count * recording.rate_Hz);
  keep(excerpts, recording.time_s);
  for (auto* signals :
       {&recording.position_rad, &recording.velocity_rad_s, &recording.torque_Nm, &recording.commanded_Nm}) {
    for (std::vector<double>& values : *signals) {
      keep(excerpts, values);
    }
  }
  for (std::vector<double>& values : recording.activation) {
    keep(excerpts, values);
  }
  recording.segments.clear();
  std::size_t first = 0;
  for (const Segment& excerpt : excerpts) {
    recording.segments.push_back({.first = first, .end = first + (excerpt.end - excerpt.first)});
    first = recording.segments.back().end;
  }
  recording.warnings.push_back(
      fmt::format("of {:.0f} s, {} stretches of {:.3g} s are analysed, spread evenly", whole_s,
                  excerpts.size(), kept / recording.rate_Hz));
}

}  // namespace

void limitLength(std::vector<Recording>& recordings, double most_s, double least_s) {
  const double limit_s = std::max(longest_s(recordings, most_s), least_s);
  for (Recording& recording : recordings) {
    if (length_s(recording) > limit_s) {
      cut(recording, limit_s);
    }
  }
}

}  // namespace patella::diagnose
