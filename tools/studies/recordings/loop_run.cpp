#include "tools/studies/recordings/loop_run.hpp"

#include <atomic>
#include <stdexcept>

#include "firmware_app/commands/run_command.hpp"
#include "tools/convert/conversion_map.hpp"
#include "tools/convert/csv_to_log.hpp"

namespace patella::study {

std::filesystem::path convertRecording(const Folders& folders, const std::filesystem::path& recording,
                                       const std::string& map, const std::string& run) {
  const can::Database database = can::loadDbc(folders.project / "drivers/can/patella.dbc");
  const auto conversion =
      convert::loadMap(folders.project / "tools/convert/maps" / (map + ".toml"), database);
  std::filesystem::create_directories(folders.out / run);
  const std::filesystem::path log = folders.out / run / (run + ".log");
  convert::convertToLog(recording, conversion, database, log);
  return log;
}

app::RunConfig loadConfig(const Folders& folders, const std::string& name, const std::string& backend) {
  app::CommandLine command_line;
  command_line.config = folders.project / "firmware_app/config" / (name + ".toml");
  command_line.backend = backend;
  command_line.clock = "virtual";
  return app::loadRunConfig(command_line);
}

app::CsvTable runRecording(const Folders& folders, const app::RunConfig& config, const std::string& run) {
  const std::filesystem::path folder = folders.out / run / "loop";
  const std::atomic<bool> stop{false};
  if (app::runLoop(config, folder, stop) == app::RunStatus::kRecordingFailed) {
    throw std::runtime_error(run + ": the loop's recording failed, see " + folder.string());
  }
  return app::CsvTable::load(folder / "ticks.csv", {.allow_missing = true});
}

}  // namespace patella::study
