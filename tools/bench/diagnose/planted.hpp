// Effects planted in measured recordings: real noise, known truth. And halves of plain recordings against
// each other, in which nothing was planted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace patella::bench {

struct PlantedOptions {
  std::filesystem::path data;    ///< folder of the recordings
  std::filesystem::path source;  ///< the project's: maps of columns and models
  std::filesystem::path out;     ///< folder for planted.csv; empty: none
  std::size_t cases = 100;
  std::size_t first = 0;  ///< number of the first case of the seed
  std::uint64_t seed = 1;
  unsigned threads = 1;
};

/// Diagnoses parts of one half of a recording with the model that the other half led to. Then adds to the
/// measured torque that of an effect which the part would have revealed, half of them exactly as large as the
/// smallest, and diagnoses with the part's own best model. Returns a summary for the console.
std::string runPlanted(const PlantedOptions& options);

}  // namespace patella::bench
