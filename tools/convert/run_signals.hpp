// The signals of a run on a uniform time base, as formats want them that have a rate in place of stamps.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace patella::convert {

/// A column of ticks.csv that holds at least one number.
struct RunSignal {
  std::string column;
  double largest = 0.0;  ///< without its sign
};

struct RunSignals {
  std::filesystem::path ticks;  ///< the file
  int rate_Hz = 0;
  std::size_t samples = 0;  ///< on the uniform time base, from the first tick to the last
  double start_s = 0.0;     ///< of the loop's time
  std::vector<RunSignal> signals;
};

/// Looks through a run's ticks.csv for the columns that begin with one of `stems` and a number, as "emg" and
/// "q". Throws app::FileError for a file with fewer than two ticks, with none of the columns, or with a rate
/// that is no whole number of ticks a second.
RunSignals findSignals(const std::filesystem::path& run, std::span<const std::string> stems);

/// Calls visit(time_s, values) for each sample, the time from the first: values are those of the signals, in
/// their order, as they were at the newest tick; zero before a signal's first. Returns how many samples had
/// no tick of their own.
std::size_t forEachSample(const RunSignals& signals,
                          const std::function<void(double time_s, std::span<const double> values)>& visit);

}  // namespace patella::convert
