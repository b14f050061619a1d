// patella: the loop executable.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/chrono.h>
#include <spdlog/fmt/fmt.h>

#include "firmware_app/commands/bounds_command.hpp"
#include "firmware_app/commands/check_command.hpp"
#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/commands/view_command.hpp"
#include "firmware_app/files/command_line.hpp"
#include "firmware_app/files/standard_streams.hpp"
#include "firmware_app/realtime/signal_reactions.hpp"

namespace {

constexpr int kError = 1;

std::atomic<bool> g_stop{false};

void requestStop(int /*signal*/) {
  g_stop.store(true);
}

/// A new folder of the name runs/DATE-TIME, with a number behind it for the second and more of one second.
/// Removed with the object where nothing has been put into it.
class DefaultFolder {
 public:
  /// Throws std::filesystem::filesystem_error.
  DefaultFolder() {
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    localtime_r(&now, &local);
    const std::string name = fmt::format("runs/{:%Y%m%d-%H%M%S}", local);
    std::filesystem::create_directories("runs");
    path_ = name;
    for (int number = 2; !std::filesystem::create_directory(path_); ++number) {
      path_ = fmt::format("{}-{}", name, number);
    }
  }
  ~DefaultFolder() {
    std::error_code not_empty;
    std::filesystem::remove(path_, not_empty);
    std::filesystem::remove("runs", not_empty);
  }
  DefaultFolder(const DefaultFolder&) = delete;
  DefaultFolder& operator=(const DefaultFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

// A variable of the shell that was never set, by no other name than the option's.
std::string requireName(const std::string& name) {
  return name.empty() ? "'', expected a file" : "";
}

void addCommon(CLI::App& command, patella::app::CommandLine& line) {
  command.add_option("--config", line.config, "run configuration, TOML")->required()->check(requireName);
  command.add_option(
      "--backend", line.backend,
      "sim, can:INTERFACE or replay:LOG; of several buses can, or can:INTERFACE,INTERFACE; wins over the "
      "configuration");
  command.add_option("--model", line.model, "model of the leg, TOML; wins over the configuration")
      ->check(requireName);
  command
      .add_option(
          "--rig-model", line.rig_model,
          "what the simulated rig really is, TOML; wins over the configuration, which --model does not touch")
      ->check(requireName);
  command
      .add_option("--reference", line.reference,
                  "reference motion, TOML with what [reference] holds; wins over it")
      ->check(requireName);
  command.add_option("--weights", line.weights, "network, safetensors; wins over the configuration")
      ->check(requireName);
  command.add_flag("--require-rt", line.require_rt, "refuse a host that cannot keep time");
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  if (argc > 1 && std::string_view(argv[1]) == "view") {
    return patella::app::becomeViewer(argv + 1);
  }
  CLI::App app("Real-time control loop for knee rehabilitation robots.", "patella");
  app.set_version_flag("--version", std::string("patella ") + PATELLA_VERSION);
  app.require_subcommand(1);

  patella::app::CommandLine line;
  std::filesystem::path folder;
  CLI::App& run = *app.add_subcommand("run", "Run the loop, on a rig, a simulated rig or a recorded log.");
  addCommon(run, line);
  run.add_option("--duration", line.duration_s, "seconds; 0 runs until Ctrl-C or the end of the log");
  run.add_option("--rate", line.rate_Hz, "ticks a second");
  run.add_option("--cpus", line.cpus, "processors to bind the loop to, as 2,3; wins over the configuration")
      ->delimiter(',');
  run.add_option("--clock", line.clock,
                 "monotonic, or virtual: as fast as the machine allows, repeatable to the bit");
  run.add_option("--seed", line.seed, "of the simulated rig");
  run.add_option("--faults", line.faults, "script of faults, TOML: what goes wrong in rig, bus and host")
      ->check(requireName);
  run.add_option("--out", folder, "folder for the recording; must not hold one (default: runs/DATE-TIME)")
      ->check([](const std::string& name) { return name.empty() ? "'', expected a folder" : ""; });
  run.footer("Exit status: 0 done, 1 could not start, 3 ended in a latched stop, 4 recording failed.");
  CLI::App& check =
      *app.add_subcommand("check", "Check a configuration and this machine's fitness for real time.");
  addCommon(check, line);
  bool ask_nodes = false;
  check.add_flag("--nodes", ask_nodes,
                 "ask the CANopen drives on the bus what they are; nothing is written to them");
  check.footer(
      "Exit status: 0 sound, 1 not, or where the host lacks what the loop cannot run without; with "
      "--require-rt "
      "also 1 where it lacks anything required.");
  const CLI::App& bounds = *app.add_subcommand(
      "bounds", "Print every key of every file, with range, default and meaning, as Markdown.");
  app.add_subcommand("view", "Serve a live run to viewers, by a process of its own: patella view --help.");
  const auto asked = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(asked).empty()) {
    fmt::print(stderr, "patella: '{}' is no command, expected run, check, bounds or view; patella --help\n",
               argv[1]);
    return kError;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return patella::app::exitAfterParsing(app, error);
  }

  try {
    if (bounds.parsed()) {
      fmt::print("{}", patella::app::boundsDocument());
      return 0;
    }
    if (run.parsed()) {
      patella::app::openStandardStreams();
      patella::app::reactToSignals(requestStop);
    }
    const patella::app::RunConfig config = patella::app::loadRunConfig(line);
    if (check.parsed()) {
      return patella::app::checkRun(config, line.require_rt, ask_nodes) ? 0 : kError;
    }
    std::optional<DefaultFolder> own_folder;
    if (folder.empty()) {
      folder = own_folder.emplace().path();
    }
    return static_cast<int>(patella::app::runLoop(config, folder, g_stop));
  } catch (const std::exception& error) {
    patella::app::show(stderr, fmt::format("patella: {}\n", error.what()));
    return kError;
  }
}
