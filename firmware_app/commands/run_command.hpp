// `patella run`: sets everything up, runs the loop, says how it went.
#pragma once

#include <atomic>
#include <filesystem>

#include "firmware_app/configuration/run_config.hpp"

namespace patella::app {

/// Exit status of `patella run`. A run that ended in a latched stop is not a success, unless it
/// replays one.
enum class RunStatus { kOk = 0, kStopped = 3, kRecordingFailed = 4 };

/// Runs until the configured duration is over, the log is at its end, or `stop` is set. Leaves frames.log,
/// ticks.csv, events.log and summary.json in `folder`, whole and without a tick where `stop` was set during
/// the set-up. Throws FileError, std::invalid_argument or std::runtime_error when the run cannot be set up.
RunStatus runLoop(const RunConfig& config, const std::filesystem::path& folder,
                  const std::atomic<bool>& stop);

}  // namespace patella::app
