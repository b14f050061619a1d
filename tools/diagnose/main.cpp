// patella-diagnose: which effect a model lacks, from recordings of the real thing.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "core/model/effect.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/output/answer.hpp"
#include "tools/diagnose/output/diagnosis_json.hpp"
#include "tools/diagnose/output/diagnosis_report.hpp"
#include "tools/diagnose/output/effects_document.hpp"
#include "tools/diagnose/output/result_folder.hpp"
#include "tools/diagnose/plan/repair.hpp"
#include "tools/diagnose/plan_command.hpp"
#include "tools/diagnose/regression/excerpts.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"
#include "tools/recordings/recording_file.hpp"

namespace {

namespace fs = std::filesystem;
using namespace patella;
using namespace patella::diagnose;

/// With fewer, no effect could stand out from chance at 0.5 %, however strong.
constexpr int kFewestReplicates = 299;
/// A torque beyond any leg's (strongest knee extensors: some 400 N·m).
constexpr double kStrongestPerson_Nm = 500.0;

struct Arguments {
  fs::path model;
  std::vector<fs::path> data;
  std::vector<fs::path> holdout;
  fs::path out;
  std::vector<std::string> effects{"all"};
  std::string torque_timing;
  RecordingOptions recording;
  DiagnoseOptions options;
};

void declare(CLI::App& app, Arguments& a) {
  app.set_version_flag("--version", std::string("patella-diagnose ") + PATELLA_VERSION);
  app.add_flag_callback(
         "--list-effects",
         [] {
           std::cout << effectsDocument();
           throw CLI::Success();
         },
         "print the library of effects, as Markdown")
      ->trigger_on_parse();
  app.add_option("--model", a.model, "model file that lacks something")->required();
  app.add_option(
         "--data", a.data,
         fmt::format("run folders of the loop, CSV files (t_s, q1_rad, tau1_Nm …: seconds, rad, N·m; on "
                     "a rail m and N) or logs of frames; diagnosed together, {:.0f} s "
                     "in evenly spread excerpts where they are longer",
                     length::kMostAnalysed_s))
      ->required();
  app.add_option("--out", a.out, "folder for report.html, diagnosis.json and model.extended.toml")
      ->required();
  app.add_option("--columns", a.recording.columns,
                 "map of the columns of a text or MATLAB file that names them its own way, TOML");
  app.add_option("--dbc", a.recording.dbc, "bus description of logs of frames");
  app.add_option("--bus-map", a.recording.bus_map,
                 "which signal is which input; the loop's own unless given");
  app.add_option("--torque", a.torque_timing,
                 "held: until the next sample; sampled: what acted at the sample; before: since the sample "
                 "before; as the form of the file and the motion say unless given")
      ->check(CLI::IsMember(torqueTimingNames()));
  auto* holdout =
      app.add_option("--holdout", a.holdout, "recordings to judge the result by, in place of a part of DATA");
  app.add_option("--holdout-fraction", a.options.holdout_fraction,
                 "last part of each recording that judges the result")
      ->check(options::numberFrom(0.05, 0.8))
      ->excludes(holdout)
      ->capture_default_str();
  app.add_option("--effects", a.effects, "kinds to consider, separated by commas, or all")->delimiter(',');
  app.add_option("--seed", a.options.seed, "of everything that is drawn by lot")
      ->check(patella::options::wholeNumberFrom(0, std::numeric_limits<std::int64_t>::max()))
      ->capture_default_str();
  app.add_option("--replicates", a.options.bootstrap_replicates,
                 "of the bootstrap that tells effects from chance")
      ->check(patella::options::wholeNumberFrom(kFewestReplicates, 100000))
      ->capture_default_str();
  app.add_option("--person", a.options.person_Nm,
                 "rms of what a person pushes with, N·m, one for each joint, separated by commas; nobody "
                 "pushes unless given")
      ->delimiter(',')
      ->check(options::numberFrom(0.0, kStrongestPerson_Nm));
  app.add_option("--nominal-tolerance", a.options.nominal_tolerance,
                 "standard deviation, relative, by which masses, centres of mass and inertias may be wrong")
      ->check(options::numberFrom(1e-4, 1.0))
      ->capture_default_str();
}

std::vector<std::string> chosenKinds(const std::vector<std::string>& effects) {
  if (effects == std::vector<std::string>{"all"}) {
    return {};
  }
  std::vector<std::string> known;
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    known.emplace_back(descriptor->kind);
  }
  for (const std::string& kind : effects) {
    if (std::find(known.begin(), known.end(), kind) == known.end()) {
      throw std::invalid_argument(fmt::format("--effects: value '{}', expected all or some of {}{}", kind,
                                              fmt::join(known, ","), app::suggestion(kind, known)));
    }
  }
  return effects;
}

// Each is cut before the next is read: the whole of some hours would not fit in memory.
std::vector<Recording> loadAll(const std::vector<fs::path>& paths, const RecordingOptions& options,
                               double heldout_fraction, ProgressLine& progress) {
  // Both parts have to be long enough to be read; a little more, as rows are whole.
  constexpr double kRoom = 1.1;
  const double shortest_part = std::min(heldout_fraction, 1.0 - heldout_fraction);
  const double least_s = kRoom * readable::kShortest_s / shortest_part;
  std::vector<Recording> recordings;
  for (const fs::path& path : paths) {
    progress.at("reading " + path.string(),
                static_cast<double>(recordings.size()) / static_cast<double>(paths.size()));
    std::vector<Recording> one;
    one.push_back(loadRecording(path, options));
    limitLength(one, length::kMostAnalysed_s, least_s);
    recordings.push_back(std::move(one.front()));
  }
  limitLength(recordings, length::kMostAnalysed_s, least_s);
  return recordings;
}

std::string heading(const Arguments& arguments, const Diagnosis& diagnosis) {
  std::string text =
      fmt::format("{} with what patella-diagnose {} found it to lack ({}), from\n",
                  arguments.model.filename().string(), PATELLA_VERSION, verdictName(diagnosis.verdict));
  for (const InputFile& input : diagnosis.inputs) {
    text += fmt::format("  {} (SHA-256 {})\n", input.path, input.sha256);
  }
  text += fmt::format("with seed {}.", diagnosis.seed);
  for (const EffectFinding& effect : diagnosis.effects) {
    for (const ParameterEstimate& estimate : effect.parameters) {
      text += fmt::format("\n{}: {}", effectWords(effect),
                          estimateText(estimate, unitsOf(diagnosis, effect.joint)));
    }
  }
  return text;
}

void run(Arguments& a) {
  a.options.effects = chosenKinds(a.effects);
  if (!a.torque_timing.empty()) {
    a.recording.torque_timing = torqueTimingNamed(a.torque_timing);
  }
  const model::ModelDescription model = app::loadModel(a.model);
  a.recording.joints = model.joints();
  if (!a.options.person_Nm.empty() &&
      a.options.person_Nm.size() != static_cast<std::size_t>(model.joints())) {
    throw std::invalid_argument(fmt::format("--person: {} values, expected {}, one for each joint of {}",
                                            a.options.person_Nm.size(), model.joints(), a.model.string()));
  }
  ResultFolder folder(a.out);
  ProgressLine progress(std::cerr, isatty(STDERR_FILENO) == 1);
  const std::vector<Recording> recordings =
      loadAll(a.data, a.recording, a.options.holdout_fraction, progress);
  const std::vector<Recording> holdout =
      loadAll(a.holdout, a.recording, a.options.holdout_fraction, progress);
  a.options.progress = [&](std::string_view stage, double fraction) { progress.at(stage, fraction); };
  Diagnosis diagnosis = diagnose::diagnose(recordings, holdout, model, a.options);
  diagnosis.plan_command = planCommandLine(diagnosis, a.model, a.out);
  progress.at("drawing", 0.0);
  folder.write({{"model.extended.toml", app::modelText(diagnosis.extended, heading(a, diagnosis))},
                {"diagnosis.json", diagnosisText(diagnosis)},
                {"report.html", diagnosisPage(diagnosis)}});
  progress.clear();
  printAnswer(diagnosis, a.out, std::cout);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  if (asksForPlan(argc, argv)) {
    return runPlan(argc, argv);
  }
  CLI::App app(
      "Finds the physical effect that a model lacks, with its parameters and how sure they are, from "
      "recordings of "
      "motion and torque.",
      "patella-diagnose");
  Arguments arguments;
  declare(app, arguments);
  app.footer("Exit status: 0 where a verdict was given, whatever it is; 1 after an error.\n\n" + planHelp());
  return patella::options::runProgram(app, argc, argv, [&] { run(arguments); });
}
