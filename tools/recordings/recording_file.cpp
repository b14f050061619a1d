#include "tools/recordings/recording_file.hpp"

#include <fstream>
#include <stdexcept>

#include "firmware_app/files/atomic_file.hpp"
#include "tools/recordings/column_map.hpp"
#include "tools/recordings/csv_recording.hpp"
#include "tools/recordings/default_bus_map.hpp"
#include "tools/recordings/log_recording.hpp"
#include "tools/recordings/mapped_recording.hpp"
#include "tools/recordings/mat_table.hpp"
#include "tools/recordings/uniform_recording.hpp"

namespace patella::diagnose {
namespace {

/// Lines of a log begin with a stamp in parentheses; no header of names does.
bool isLog(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return !isMatFile(file) && (stream >> std::ws).peek() == '(';
}

app::BusDescription busOf(const std::filesystem::path& log, const RecordingOptions& options) {
  if (options.columns) {
    throw app::FileError(log.string() + ": is a log of frames, which a map of columns (" +
                         options.columns->string() + ") does not describe; expected --dbc");
  }
  if (options.bus_map) {
    constexpr bool kRehearsal = true;  // a recording moves no motor, whatever its map waits for
    return app::loadBusDescription(*options.bus_map, options.dbc, kRehearsal);
  }
  if (!options.dbc) {
    throw app::FileError(log.string() +
                         ": is a log of frames, expected the description of its bus (--dbc) with it");
  }
  return app::parseBusDescription(kDefaultBusMap, "bus map of the loop", options.dbc);
}

RawRecording readFrames(const std::filesystem::path& log, const RecordingOptions& options) {
  const app::BusDescription bus = busOf(log, options);
  try {
    return readLog(log, bus, options.joints, options.torque_timing == TorqueTiming::kSampled);
  } catch (const std::invalid_argument& error) {
    throw app::FileError(log.string() + ": the bus map does not suit a model of " +
                         (options.joints == 1 ? "one joint" : std::to_string(options.joints) + " joints") +
                         " and the bus description: " + error.what());
  }
}

RawRecording readTable(const std::filesystem::path& file, const RecordingOptions& options) {
  if (options.columns) {
    return readMappedRecording(file, options.joints, loadColumnMap(*options.columns));
  }
  if (isMatFile(file)) {
    throw app::FileError(file.string() +
                         ": is a MATLAB file, expected a map of its variables (--columns); it holds " +
                         matContents(file));
  }
  return isLoopTable(file) ? readLoopTable(file, options.joints,
                                           options.torque_timing == TorqueTiming::kSampled, options.truth)
                           : readNamedColumns(file, options.joints);
}

// Where too little is left of a file, the refusal says that it is not whole.
Recording uniformOf(RawRecording raw) {
  const std::string cut_off = raw.cut_off;
  try {
    return makeUniform(std::move(raw));
  } catch (const app::FileError& error) {
    if (cut_off.empty()) {
      throw;
    }
    throw app::FileError(std::string(error.what()) + "; " + cut_off);
  }
}

}  // namespace

Recording loadRecording(const std::filesystem::path& path, const RecordingOptions& options) {
  const std::filesystem::path file = std::filesystem::is_directory(path) ? path / "ticks.csv" : path;
  // Before anything else: a file that cannot be read is reported as such.
  std::string sha256 = app::fileSha256(file);
  if (options.torque_timing == TorqueTiming::kBefore && (isLog(file) || isLoopTable(file))) {
    throw app::FileError(
        file.string() +
        ": was recorded by the loop or on its bus, where the time at which a torque acted is "
        "known: expected held or sampled for --torque");
  }
  RawRecording raw = isLog(file) ? readFrames(file, options) : readTable(file, options);
  raw.torque_timing = options.torque_timing.value_or(raw.torque_timing);
  raw.torque_timing_assumed = raw.torque_timing_assumed && !options.torque_timing;
  Recording recording = uniformOf(std::move(raw));
  recording.sha256 = std::move(sha256);
  return recording;
}

}  // namespace patella::diagnose
