#include "tools/recordings/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "firmware_app/files/file_error.hpp"
#include "tools/recordings/reading_limits.hpp"

namespace patella::diagnose {
namespace {

using namespace outliers;

using Signals = std::array<std::vector<double>, kMaxJoints>;

/// Values that quantiles are taken of, at most: enough for those that are asked for.
constexpr std::size_t kMostSorted = 200'000;

struct Outlier {
  std::size_t row = 0;
  std::string signal;
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< what the signal uses otherwise
};

struct Range {
  double low = 0.0, high = 0.0;
  double width() const noexcept { return high - low; }
};

std::vector<double> sortedPart(std::span<const double> values) {
  std::vector<double> part;
  const std::size_t step = values.size() / kMostSorted + 1;
  for (std::size_t i = 0; i < values.size(); i += step) {
    part.push_back(values[i]);
  }
  std::sort(part.begin(), part.end());
  return part;
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

// The range of a signal that hardly ever leaves one value is the one it has when it does.
Range rangeOf(std::span<const double> values) {
  constexpr double kRareBulk = 0.001;
  const std::vector<double> sorted = sortedPart(values);
  for (const double share : {kBulk, kRareBulk}) {
    const Range range{.low = quantile(sorted, share), .high = quantile(sorted, 1.0 - share)};
    if (range.width() > 0.0 || share == kRareBulk) {
      return range;
    }
  }
  return {};
}

class Finder {
 public:
  explicit Finder(const RawRecording& recording) : recording_(recording) {
    std::vector<double> steps;
    for (std::size_t row = 1; row < recording.rows(); ++row) {
      steps.push_back(recording.stamp_s[row] - recording.stamp_s[row - 1]);
    }
    const double step_s = std::max(1e-9, quantile(sortedPart(steps), 0.5));
    longest_ = std::max(kLongestBurst_rows, static_cast<std::size_t>(kLongestBurst_s / step_s));
  }

  std::vector<Outlier> all() {
    look(recording_.position_rad, "position of joint", true);
    look(recording_.velocity_rad_s, "velocity of joint", false);
    look(recording_.torque_Nm, "torque of joint", false);
    look(recording_.commanded_Nm, "commanded torque of joint", false);
    const auto place = [](const Outlier& outlier) { return std::tie(outlier.row, outlier.signal); };
    std::sort(found_.begin(), found_.end(),
              [&](const Outlier& a, const Outlier& b) { return place(a) < place(b); });
    // A position that leaves its range has jumped, too.
    found_.erase(std::unique(found_.begin(), found_.end(),
                             [&](const Outlier& a, const Outlier& b) { return place(a) == place(b); }),
                 found_.end());
    return std::move(found_);
  }

 private:
  // Joints of one machine move and are driven alike, so that the widest range serves them all: one that
  // stands still, or has no current, has next to none of its own.
  void look(const Signals& signals, const char* stem, bool jumps) {
    std::array<Range, kMaxJoints> ranges;
    double widest = 0.0;
    for (std::size_t j = 0; j < signals.size(); ++j) {
      ranges[j] = signals[j].empty() ? Range{} : rangeOf(signals[j]);
      widest = std::max(widest, ranges[j].width());
    }
    for (std::size_t j = 0; j < signals.size(); ++j) {
      if (!signals[j].empty()) {
        name_ = fmt::format("{} {}", stem, j + 1);
        leaving(signals[j], ranges[j], widest);
        if (jumps) {
          jumping(signals[j], ranges[j], widest);
        }
      }
    }
  }

  void leaving(std::span<const double> values, const Range& range, double widest) {
    const Range bound{.low = range.low - kBeyond * widest, .high = range.high + kBeyond * widest};
    const auto outside = [&](std::size_t row) { return values[row] < bound.low || values[row] > bound.high; };
    const auto absurd = [&](std::size_t row) {
      return widest > 0.0 && std::max(range.low - values[row], values[row] - range.high) > kAbsurd * widest;
    };
    for (std::size_t row = 0; row < values.size();) {
      std::size_t end = row;
      while (end < values.size() && outside(end)) {
        ++end;
      }
      const bool burst = end - row <= longest_;
      for (; row < end; ++row) {
        if (burst || absurd(row)) {
          add(row, values[row], range);
        }
      }
      row = end + 1;
    }
  }

  // Out and back within a burst, by more than any ordinary step.
  void jumping(std::span<const double> values, const Range& range, double widest) {
    std::vector<double> steps;
    for (std::size_t row = 1; row < values.size(); ++row) {
      steps.push_back(std::abs(values[row] - values[row - 1]));
    }
    const double least = std::max(kJump * widest, kJumpSteps * quantile(sortedPart(steps), kOrdinarySteps));
    if (least <= 0.0) {
      return;
    }
    for (std::size_t row = 1; row < values.size(); ++row) {
      if (steps[row - 1] <= least) {
        continue;
      }
      const double before = values[row - 1];
      std::size_t end = row + 1;
      while (end < values.size() && end - row <= longest_ &&
             std::abs(values[end] - before) > kBack * steps[row - 1]) {
        ++end;
      }
      if (end < values.size() && end - row <= longest_) {
        for (; row < end; ++row) {
          add(row, values[row], range);
        }
      }
    }
  }

  void add(std::size_t row, double value, const Range& range) {
    found_.push_back({.row = row, .signal = name_, .value = value, .low = range.low, .high = range.high});
  }

  const RawRecording& recording_;
  std::size_t longest_ = 0;
  std::string name_;
  std::vector<Outlier> found_;
};

std::string textOf(const RawRecording& recording, const Outlier& outlier) {
  return fmt::format("{}: {} is {:.4g} at {:.6g} s, where it otherwise lies within {:.3g} to {:.3g}",
                     placeOf(recording, outlier.row), outlier.signal, outlier.value,
                     recording.stamp_s[outlier.row], outlier.low, outlier.high);
}

}  // namespace

void dropOutliers(RawRecording& recording) {
  if (recording.rows() < 2 * kLongestBurst_rows) {
    return;
  }
  const std::vector<Outlier> found = Finder(recording).all();
  if (found.empty()) {
    return;
  }
  std::vector<std::size_t> kept;
  std::size_t next = 0;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (next == found.size() || found[next].row != row) {
      kept.push_back(row);
    }
    while (next < found.size() && found[next].row == row) {
      ++next;
    }
  }
  const std::size_t rows = recording.rows() - kept.size();
  if (static_cast<double>(rows) > std::max(1.0, kMost * static_cast<double>(recording.rows()))) {
    throw app::FileError(fmt::format(
        "{}; {} of {} rows are like that, which no motion and no drive explains, expected at most {:.1f} %",
        textOf(recording, found.front()), rows, recording.rows(), 100.0 * kMost));
  }
  for (std::size_t i = 0; i < std::min(kNamed, found.size()); ++i) {
    recording.warnings.push_back(textOf(recording, found[i]) + ": the row is left out");
  }
  if (found.size() > kNamed) {
    recording.warnings.push_back(fmt::format(
        "{} rows that no motion and no drive explains are left out, of which the first are named", rows));
  }
  keepRows(recording, kept);
}

}  // namespace patella::diagnose
