// What the comparison says: a table, and a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/bench/jitter/distribution.hpp"

namespace patella::bench {

/// One condition, both programs.
struct Comparison {
  std::string condition;  ///< "idle", "loaded"
  Distribution loop;
  Distribution cyclictest;
  std::vector<double> turn_ratios;  ///< of the p99.9 in each turn, the loop's to cyclictest's
};

std::string table(const std::vector<Comparison>& comparisons);
/// Fraction of wake-ups later than x, both programs in one figure for each condition.
void draw(const std::vector<Comparison>& comparisons, const std::filesystem::path& picture);
/// condition,program,upper_us,count
void writeCsv(const std::vector<Comparison>& comparisons, const std::filesystem::path& path);

}  // namespace patella::bench
