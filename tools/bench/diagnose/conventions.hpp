// Measured recordings with one wrong convention each, or two: real noise, and mistakes that are known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace patella::bench {

struct ConventionOptions {
  std::filesystem::path data;    ///< folder of the recordings
  std::filesystem::path source;  ///< the project's: maps of columns and models
  std::filesystem::path out;     ///< folder for conventions.csv; empty: none
  std::size_t cases = 100;
  std::uint64_t seed = 1;
  std::size_t mistakes = 1;  ///< in each copy
  bool judge_only = false;   ///< what is believed is not diagnosed
};

/// Diagnoses recordings with the model that their makers publish and with the model that they led to, first
/// as they are, then copies with drawn mistakes. Recordings that a model does not explain are left out with
/// it, and so are mistakes that nothing can tell, since the model's error does not grow. Returns a summary
/// for the console.
std::string runConventions(const ConventionOptions& options);

}  // namespace patella::bench
