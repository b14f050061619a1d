// patella-study-measured: figures that other people's recordings are known by.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware_app/files/model_file.hpp"
#include "tools/diagnose/checks/drive_timing.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"
#include "tools/recordings/recording_file.hpp"
#include "tools/studies/measured/emps_error.hpp"

namespace {

namespace fs = std::filesystem;
using namespace patella;

struct Arguments {
  std::vector<fs::path> data;
  fs::path columns;
  std::vector<fs::path> models;
  double holdout_fraction = 0.3;
  std::string torque;
};

std::vector<diagnose::Recording> load(const Arguments& arguments, int joints) {
  std::vector<diagnose::Recording> recordings;
  diagnose::RecordingOptions options{.joints = joints, .columns = arguments.columns};
  if (!arguments.torque.empty()) {
    options.torque_timing =
        arguments.torque == "held" ? diagnose::TorqueTiming::kHeld : diagnose::TorqueTiming::kSampled;
  }
  for (const fs::path& path : arguments.data) {
    recordings.push_back(diagnose::loadRecording(path, options));
  }
  return recordings;
}

void printErrors(const Arguments& arguments) {
  const diagnose::Recording recording = load(arguments, 1).front();
  std::printf("  %-46s%10s%10s%10s\n", "relative error of the force, %", "train", "held out", "all");
  for (const fs::path& path : arguments.models) {
    const study::RelativeError error =
        study::relativeError(recording, app::loadModel(path), 1.0 - arguments.holdout_fraction);
    std::printf("  %-46s%10.2f%10.2f%10.2f\n", (path.parent_path().filename() / path.filename()).c_str(),
                error.train_percent, error.heldout_percent, error.all_percent);
  }
}

void printTiming(const Arguments& arguments) {
  std::printf("  %-16s%6s%12s%10s%26s\n", "drive", "joint", "delay / ms", "lag / ms",
              "relative error, % before");
  const auto line = [](const std::string& name, const std::vector<diagnose::Recording>& recordings) {
    constexpr double kMilli = 1e3;
    constexpr double kPercent = 100.0;
    for (const diagnose::DriveTiming& timing : diagnose::driveTiming(recordings)) {
      std::printf("  %-16s%6d%12.1f%10.1f%20.1f → %.1f\n", name.c_str(), timing.joint + 1,
                  kMilli * timing.delay_s, kMilli * timing.lag_s, kPercent * timing.relative_error_before,
                  kPercent * timing.relative_error_after);
    }
  };
  const std::vector<diagnose::Recording> recordings = load(arguments, 2);
  for (const diagnose::Recording& recording : recordings) {
    line(fs::path(recording.name).stem().string(), {recording});
  }
  line("together", recordings);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app("Figures that other people's recordings are known by.", "patella-study-measured");
  app.require_subcommand(1);
  Arguments arguments;
  CLI::App& errors = *app.add_subcommand("emps", "Relative force error of models of the EMPS axis.");
  CLI::App& timing =
      *app.add_subcommand("timing", "Delay and lag of two drives, each recording and together.");
  for (CLI::App* command : {&errors, &timing}) {
    command->add_option("--data", arguments.data, "recordings, CSV")->required()->check(CLI::ExistingFile);
    command->add_option("--columns", arguments.columns, "map of their columns")
        ->required()
        ->check(CLI::ExistingFile);
  }
  errors.add_option("--models", arguments.models, "model files")->required()->check(CLI::ExistingFile);
  errors
      .add_option("--holdout-fraction", arguments.holdout_fraction, "last part of the recording, told apart")
      ->check(options::numberFrom(0.05, 0.8))
      ->capture_default_str();
  errors
      .add_option(
          "--torque", arguments.torque,
          "held: the force acts until the next sample; sampled: at its own instant, as the benchmark counts "
          "it; as the map says unless given")
      ->check(CLI::IsMember({"held", "sampled"}));
  return patella::options::runProgram(app, argc, argv, [&] {
    if (errors.parsed()) {
      printErrors(arguments);
    } else {
      printTiming(arguments);
    }
  });
}
