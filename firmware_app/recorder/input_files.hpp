// The files that a run was configured from, with what they held.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/formats/mcap_run.hpp"

namespace patella::app {

/// A file as it was when the run began.
struct InputFile {
  std::string role;
  std::filesystem::path path;
  std::string sha256;
};

/// Reads every file that the configuration names. Throws FileError.
std::vector<InputFile> inputFiles(const RunConfig& config);

/// Roles of those that are no longer as they were.
std::vector<std::string> changedFiles(const std::vector<InputFile>& files);

/// A line for each, to begin events.log with.
std::string inputLines(const std::vector<InputFile>& files);

/// The same with the files themselves, for a recording that travels alone. The log of a replay stays where it
/// is: what was played is in the recording. Throws FileError.
formats::RunInputs mcapInputs(const std::vector<InputFile>& files);

}  // namespace patella::app
