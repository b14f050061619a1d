// Every method in every condition: tuned on some seeds, measured on others.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/studies/observers/evaluation.hpp"

namespace patella::study {

struct StudyOptions {
  std::vector<Condition> conditions{kConditions.begin(), kConditions.end()};
  double seconds = 50.0;
  int seeds = 10;        ///< measured on 1 … seeds
  int tuning_seeds = 1;  ///< tuned on 101 … 100 + tuning_seeds
  int jobs = 1;          ///< threads
};

struct Spread {
  double mean = 0.0;
  double deviation = 0.0;  ///< standard, over seeds
};

/// One method in one condition, joint by joint.
struct Result {
  Condition condition;
  const Method* method = nullptr;
  std::vector<double> values;  ///< as tuned
  std::array<Spread, 2> error;
  std::array<Spread, 2> delay_s;
};

inline constexpr std::uint64_t kFirstTuningSeed = 101;

/// Recordings of the seeds from `first`.
std::vector<Recording> recordAll(const Condition& condition, double seconds, std::uint64_t first, int count);

/// Tunes a method on some recordings and measures it on others, all of one condition.
Result measure(const Method& method, const std::vector<Recording>& tuning,
               const std::vector<Recording>& recordings);

/// Mean and deviation of one value a seed.
Spread spreadOf(const std::vector<double>& values);

/// In the order of the conditions and, in each, of methods(). The same for any number of jobs.
std::vector<Result> study(const StudyOptions& options);

/// A table in Markdown for each condition.
std::string tables(const std::vector<Result>& results);
/// A line a condition, method and joint.
void writeCsv(const std::vector<Result>& results, const std::filesystem::path& path);
/// The errors as bars.
void draw(const std::vector<Result>& results, const std::filesystem::path& path);

}  // namespace patella::study
