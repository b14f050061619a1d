// patella-study-recordings: people's EMG and a real arm's motion through the whole loop, against what was
// measured with them.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/checkout/checkout.hpp"
#include "tools/options/run_program.hpp"
#include "tools/studies/recordings/emg_study.hpp"
#include "tools/studies/recordings/pendulum_study.hpp"
#include "tools/studies/recordings/tables.hpp"

namespace {

using namespace patella::study;

template <typename Study, typename Run>
std::vector<Study> studyAll(const char* what, const std::vector<std::string>& names, Run&& run) {
  std::vector<Study> studies;
  for (const std::string& name : names) {
    std::fprintf(stderr, "%s %zu of %zu: %s\n", what, studies.size() + 1, names.size(), name.c_str());
    studies.push_back(run(name));
  }
  return studies;
}

void bench(const Folders& folders) {
  std::filesystem::create_directories(folders.out);
  const auto people = studyAll<EmgStudy>("EMG", recordedPeople(),
                                         [&](const std::string& name) { return studyEmg(folders, name); });
  const auto runs = studyAll<PendulumStudy>(
      "arm", recordedPendulumRuns(), [&](const std::string& name) { return studyPendulum(folders, name); });
  std::cout << "\n" << emgTable(people) << "\n" << pendulumTable(runs) << "\n";

  drawEmg(people, folders.out / "leg_emg.png");
  for (const PendulumStudy& run : runs) {
    drawPendulum(run, folders.out / ("double_pendulum_" + run.run + ".png"));
  }
  std::cout << "  pictures in " << folders.out.string() << "\n";
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app("Runs recorded EMG and a recorded arm through the loop and compares with what was measured.",
               "patella-study-recordings");
  Folders folders{.data = {}, .project = patella::checkout::source(), .out = {}};
  app.add_option("--data", folders.data, "folder with leg_emg and double_pendulum")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--out", folders.out, "folder for runs and pictures")->required();
  app.add_option("--project", folders.project, "checkout with configurations and maps")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  return patella::options::runProgram(app, argc, argv, [&] { bench(folders); });
}
