// patella-study-learning: what a network adds to the best observer.
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "firmware_app/files/model_file.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"
#include "tools/recordings/recording_file.hpp"
#include "tools/studies/learning/leg_study.hpp"
#include "tools/studies/learning/pendulum_study.hpp"
#include "tools/studies/learning/tables.hpp"
#include "tools/train/linear_path.hpp"

namespace {

using namespace patella::study;

constexpr const char* kLegs =
    "Legs, motions and pushes that were never seen: the network on the best observer, against that observer.";

constexpr const char* kPendulum =
    "A measured two-link arm: torque error of models, alone and with a network, on recordings of their own.";

struct PendulumArguments {
  PendulumStudyOptions options;
  std::vector<std::string> models;
  std::vector<std::string> data;
  std::vector<std::string> test_data;
  std::string columns;
};

struct LegArguments {
  LegStudyOptions options;
  std::vector<std::string> errors{"0"};
  std::vector<double> horizons_ms{0.0};
  bool individual = false;
};

void declareTraining(CLI::App& app, patella::train::TrainingOptions& t) {
  app.add_option("--hidden", t.hidden)->capture_default_str();
  app.add_option("--channels", t.channels)->capture_default_str();
  app.add_option("--heads", t.heads)->capture_default_str();
  app.add_option("--window", t.window)->capture_default_str();
  app.add_option("--epochs", t.epochs)->capture_default_str();
  app.add_option("--patience", t.patience)->capture_default_str();
  app.add_option("--batch", t.batch)->capture_default_str();
  app.add_option("--sequence-steps", t.sequence_steps)->capture_default_str();
  app.add_option("--burn-in", t.burn_in)->capture_default_str();
  app.add_option("--layers", t.layers)->capture_default_str();
  app.add_option("--learning-rate", t.learning_rate)->capture_default_str();
}

void declare(CLI::App& app, LegArguments& a) {
  LegStudyOptions& o = a.options;
  app.add_option("--errors", a.errors, "of the shank's mass and inertia in percent, or friction")
      ->delimiter(',')
      ->capture_default_str();
  app.add_flag("--individual", a.individual, "each patient has his own error within those bounds");
  app.add_option("--horizons-ms", a.horizons_ms, "how far ahead")->delimiter(',')->capture_default_str();
  app.add_flag("--ablations", o.ablations, "besides: without linear path, attention, rises, the observer");
  app.add_flag("--shank-share", o.shank_share,
               "besides: networks that see what a heavier shank would explain, fitted as the run goes on");
  app.add_flag("--passive", o.passive, "train on runs in which nobody pushes");
  app.add_flag("--adapt", o.adapt, "besides: Kalman filters that adapt the model's parameters");
  app.add_flag("!--no-network", o.network, "observers and filters alone, nothing trained");
  app.add_option("--first-seed", o.first_seed, "from which the seeds go up")
      ->check(patella::options::wholeNumberFrom(1, 10000))
      ->capture_default_str();
  app.add_option("--seeds", o.seeds)->check(patella::options::wholeNumberFrom(1, 100))->capture_default_str();
  app.add_option("--runs", o.training_runs, "to train on, of each seed")
      ->check(patella::options::wholeNumberFrom(3, 2000))
      ->capture_default_str();
  app.add_option("--test-runs", o.test_runs)
      ->check(patella::options::wholeNumberFrom(1, 500))
      ->capture_default_str();
  app.add_option("--seconds", o.seconds, "length of a run")
      ->check(patella::options::numberFrom(4.0, 600.0))
      ->capture_default_str();
  app.add_option("--rate-Hz", o.rate_Hz, "of the network")->capture_default_str();
  declareTraining(app, o.training);
}

void declare(CLI::App& app, PendulumArguments& a) {
  app.add_option("--models", a.models, "model files")->required()->check(CLI::ExistingFile);
  app.add_option("--data", a.data, "recordings to train on")->required()->check(CLI::ExistingFile);
  app.add_option("--test-data", a.test_data, "recordings to test on")->required()->check(CLI::ExistingFile);
  app.add_option("--columns", a.columns, "map of their columns")->required()->check(CLI::ExistingFile);
  app.add_option("--seeds", a.options.seeds)
      ->check(patella::options::wholeNumberFrom(1, 100))
      ->capture_default_str();
  app.add_option("--weight-decay", a.options.training.weight_decay)->capture_default_str();
  declareTraining(app, a.options.training);
}

std::vector<patella::diagnose::Recording> load(const std::vector<std::string>& paths,
                                               const std::string& columns) {
  std::vector<patella::diagnose::Recording> recordings;
  for (const std::string& path : paths) {
    recordings.push_back(patella::diagnose::loadRecording(path, {.joints = 2, .columns = columns}));
  }
  return recordings;
}

void runPendulum(const PendulumArguments& a) {
  checked(a.options.training);
  const auto training = load(a.data, a.columns);
  const auto test = load(a.test_data, a.columns);
  std::vector<PendulumResult> results;
  for (const std::string& path : a.models) {
    const std::string name = std::filesystem::path(path).filename().string();
    results.push_back(pendulumStudy(patella::app::loadModel(path), name, training, test, a.options));
  }
  std::cout << table(results);
}

void tell(const LegResult& result) {
  std::cerr << line(result) << std::flush;
}

void understand(LegArguments& a) {
  for (const std::string& text : a.errors) {
    if (text == "friction") {
      a.options.errors.push_back({.friction = true});
      continue;
    }
    double percent = 0.0;
    if (!CLI::detail::lexical_cast(text, percent) || percent < 0.0 || percent > 90.0) {
      throw std::invalid_argument("--errors: value '" + text +
                                  "', expected percent from 0 to 90, or friction");
    }
    a.options.errors.push_back({.shank = 0.01 * percent, .individual = a.individual && percent > 0.0});
  }
  a.options.horizons_s.clear();
  for (const double horizon_ms : a.horizons_ms) {
    a.options.horizons_s.push_back(1e-3 * horizon_ms);
  }
  checked(a.options.training);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app("What a network adds to the best observer.", "patella-study-learning");
  app.require_subcommand(1);
  LegArguments legs;
  legs.options.training = {.hidden = 48,
                           .channels = 32,
                           .heads = 4,
                           .window = 32,
                           .linear_lags = patella::train::usualLags(),
                           .loss = patella::train::Loss::kAbsolute,
                           .epochs = 40,
                           .sequence_steps = 160,
                           .burn_in = 48,
                           .learning_rate = 4e-3};
  PendulumArguments pendulum;
  pendulum.options.training = {.hidden = 16,
                               .channels = 16,
                               .heads = 2,
                               .window = 16,
                               .patience = 60,
                               .epochs = 300,
                               .batch = 8,
                               .sequence_steps = 96,
                               .burn_in = 24,
                               .learning_rate = 5e-3,
                               .weight_decay = 0.02};
  CLI::App& pendulum_command = *app.add_subcommand("pendulum", kPendulum);
  declare(pendulum_command, pendulum);
  CLI::App& leg_command = *app.add_subcommand("legs", kLegs);
  declare(leg_command, legs);
  return patella::options::runProgram(app, argc, argv, [&] {
    if (pendulum_command.parsed()) {
      runPendulum(pendulum);
    } else {
      understand(legs);
      std::cout << table(legStudy(legs.options, tell));
    }
  });
}
