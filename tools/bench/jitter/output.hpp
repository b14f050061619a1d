// Results of the comparison: a table, and a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/bench/jitter/turn_ratio.hpp"

namespace patella::bench {

/// One condition, both programs.
struct Comparison {
  std::string condition;  ///< of the machine: "as is", "loaded"
  std::vector<Turn> turns;
};

/// Quantiles of both programs over all turns, and the ratio of their p99.9 with its interval.
std::string table(const std::vector<Comparison>& comparisons);
/// Fraction of wake-ups later than x, both programs in one figure for each condition.
void draw(const std::vector<Comparison>& comparisons, const std::filesystem::path& picture);
/// condition,program,upper_us,count
void writeCsv(const std::vector<Comparison>& comparisons, const std::filesystem::path& path);

}  // namespace patella::bench
