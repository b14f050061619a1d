// Summary of a run: summary.json for programs, a page of text for people.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "drivers/can/bus.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/realtime/realtime_setup.hpp"
#include "firmware_app/recorder/loop_statistics.hpp"
#include "firmware_app/recorder/recorder.hpp"

namespace patella::app {

/// A file that the run was configured from, as it was when the run began.
struct InputFile {
  std::string role;
  std::filesystem::path path;
  std::string sha256;
};

/// Reads every file that the configuration names. Throws FileError.
std::vector<InputFile> inputFiles(const RunConfig& config);

/// Roles of those that are no longer as they were.
std::vector<std::string> changedFiles(const std::vector<InputFile>& files);

/// Only what the run determines, no date and no path of the output, so that two equal runs have equal
/// summaries. `realtime` may be null: then (virtual clock) nothing of the host is in it.
nlohmann::ordered_json summarise(const RunConfig& config, const std::vector<InputFile>& files,
                                 const LoopStatistics& loop, const can::Bus& bus,
                                 const can::MeasurementDecoder& decoder, const Recorder& recorder,
                                 const RealtimeReport* realtime);

/// The same for the console.
std::string summaryText(const nlohmann::ordered_json& summary);

}  // namespace patella::app
