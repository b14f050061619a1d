#include "tools/convert/run_signals.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/convert/progress.hpp"
#include "tools/convert/run_rows.hpp"

namespace patella::convert {
namespace {

bool isOf(const std::string& column, std::span<const std::string> stems) {
  return std::any_of(stems.begin(), stems.end(), [&](const std::string& stem) {
    return column.size() > stem.size() && column.starts_with(stem) &&
           std::isdigit(static_cast<unsigned char>(column[stem.size()])) != 0;
  });
}

std::size_t indexOf(const RunRows& rows, const std::string& column, const std::filesystem::path& file) {
  const auto found = std::find(rows.columns().begin(), rows.columns().end(), column);
  if (found == rows.columns().end()) {
    throw app::FileError(file.string() + ": no column '" + column + "', expected those of a run");
  }
  return static_cast<std::size_t>(found - rows.columns().begin());
}

// Most steps from tick to tick are one period; a lost tick makes a longer one.
int rateOf(std::vector<double> steps_s, const std::filesystem::path& file) {
  constexpr double kTolerance = 1e-6;
  if (steps_s.empty()) {
    throw app::FileError(file.string() + ": fewer than two ticks, expected a recorded run");
  }
  const auto middle = steps_s.begin() + static_cast<long>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  const double rate_Hz = 1.0 / *middle;
  const double whole_Hz = std::round(rate_Hz);
  if (!(whole_Hz >= 1.0 && whole_Hz <= 20'000.0 && std::abs(rate_Hz - whole_Hz) <= kTolerance * whole_Hz)) {
    throw app::FileError(file.string() + ": " + app::formatNumber(rate_Hz) +
                         " ticks a second, expected a whole number from 1 to 20000");
  }
  return static_cast<int>(whole_Hz);
}

// A conversion reads the file twice: `before` of it is done when this reading begins, which is half of it.
class HalfProgress {
 public:
  HalfProgress(const std::filesystem::path& file, double before)
      : size_(static_cast<double>(std::filesystem::file_size(file))), before_(before) {}
  void at(const RunRows& rows) {
    progress_.at(before_ + 0.5 * static_cast<double>(rows.bytesRead()) / size_);
  }

 private:
  Progress progress_;
  double size_;
  double before_;
};

}  // namespace

RunSignals findSignals(const std::filesystem::path& run, std::span<const std::string> stems) {
  constexpr std::size_t kStepsThatTell = 10'001;
  RunSignals found;
  found.ticks = run / "ticks.csv";
  RunRows rows(found.ticks);
  const std::size_t time = indexOf(rows, "t_s", found.ticks);
  std::vector<double> largest(rows.columns().size(), -1.0);  // −1: never a number
  std::vector<double> row;
  std::vector<double> steps_s;
  double last_s = 0.0;
  std::size_t count = 0;
  HalfProgress progress(found.ticks, 0.0);
  while (rows.next(row)) {
    progress.at(rows);
    if (count == 0) {
      found.start_s = row[time];
    } else if (!(row[time] > last_s)) {
      throw app::FileError(found.ticks.string() + ": tick " + std::to_string(count + 1) + ": time " +
                           app::formatNumber(row[time]) + " s, expected more than " +
                           app::formatNumber(last_s));
    } else if (steps_s.size() < kStepsThatTell) {
      steps_s.push_back(row[time] - last_s);
    }
    last_s = row[time];
    ++count;
    for (std::size_t i = 0; i < row.size(); ++i) {
      largest[i] = std::isfinite(row[i]) ? std::max(largest[i], std::abs(row[i])) : largest[i];
    }
  }
  found.rate_Hz = rateOf(std::move(steps_s), found.ticks);
  found.samples = static_cast<std::size_t>(std::llround((last_s - found.start_s) * found.rate_Hz)) + 1;
  for (std::size_t i = 0; i < largest.size(); ++i) {
    if (largest[i] >= 0.0 && isOf(rows.columns()[i], stems)) {
      found.signals.push_back({rows.columns()[i], largest[i]});
    }
  }
  if (found.signals.empty()) {
    throw app::FileError(found.ticks.string() + ": no column " +
                         app::quotedList({stems.begin(), stems.end()}) + " with a number holds a value");
  }
  return found;
}

std::size_t forEachSample(const RunSignals& signals,
                          const std::function<void(double time_s, std::span<const double> values)>& visit) {
  RunRows rows(signals.ticks);
  const std::size_t time = indexOf(rows, "t_s", signals.ticks);
  std::vector<std::size_t> indices;
  for (const RunSignal& signal : signals.signals) {
    indices.push_back(indexOf(rows, signal.column, signals.ticks));
  }
  std::vector<double> values(indices.size(), 0.0);
  std::vector<double> row;
  std::size_t next = 0;
  std::size_t held = 0;
  const auto give = [&] {
    visit(static_cast<double>(next) / signals.rate_Hz, values);
    ++next;
  };
  HalfProgress progress(signals.ticks, 0.5);
  while (rows.next(row)) {
    progress.at(rows);
    const auto at = static_cast<std::size_t>(std::llround((row[time] - signals.start_s) * signals.rate_Hz));
    while (next < at) {
      give();
      ++held;
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      values[i] = std::isfinite(row[indices[i]]) ? row[indices[i]] : values[i];
    }
    if (next == at) {
      give();
    }
  }
  return held;
}

}  // namespace patella::convert
