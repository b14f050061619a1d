// A recording through the whole loop: converted to frames, run in virtual time, read back.
#pragma once

#include <filesystem>
#include <string>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/csv_table.hpp"

namespace patella::study {

struct Folders {
  std::filesystem::path data;     ///< the recordings
  std::filesystem::path project;  ///< checkout, for configurations and maps
  std::filesystem::path out;      ///< gets one folder a run
};

/// Converts with the map of that name into <out>/<run>/<run>.log and returns its path. Throws as the
/// converter.
std::filesystem::path convertRecording(const Folders& folders, const std::filesystem::path& recording,
                                       const std::string& map, const std::string& run);

/// The configuration of that name, in virtual time. Throws app::FileError.
app::RunConfig loadConfig(const Folders& folders, const std::string& name, const std::string& backend);

/// Runs the loop in <out>/<run>/loop and returns what it recorded, one row a tick. Throws std::runtime_error
/// when the run stops or loses a recorded tick.
app::CsvTable runRecording(const Folders& folders, const app::RunConfig& config, const std::string& run);

}  // namespace patella::study
