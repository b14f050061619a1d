// A run for OpenSim: tables of text with a header of their own, .sto for any signals and .mot for coordinates
// (https://opensimconfluence.atlassian.net, "Storage (.sto) Files" and "Motion (.mot) Files").
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace patella::convert {

struct OpenSimReport {
  std::size_t rows = 0;
  std::vector<std::string> columns;  ///< without the time
};

/// Writes EMG, activation and drive torques with the names that ticks.csv has, a row a tick. Throws
/// std::runtime_error naming the file; nothing is left behind then.
OpenSimReport convertRunToSto(const std::filesystem::path& run, const std::filesystem::path& sto);

/// Writes the joints' angles in radians. `coordinates` are their names in the OpenSim model, one for each
/// joint; empty: joint_1 and on. Signs and zeros stay the loop's.
OpenSimReport convertRunToMot(const std::filesystem::path& run, const std::vector<std::string>& coordinates,
                              const std::filesystem::path& mot);

}  // namespace patella::convert
