// patella-study-paper: the experiments of the paper's Section 5, its figures and its Table 1.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <CLI/CLI.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"
#include "tools/studies/paper/paper_figures.hpp"
#include "tools/studies/paper/paper_study.hpp"
#include "tools/studies/paper/paper_tables.hpp"

namespace {

using namespace patella::study;
namespace sim = patella::sim;
namespace train = patella::train;

constexpr const char* kDescription =
    R"(The paper's Section 5: experiments 1 and 2, figures 3 to 10, Table 1.

Forms: as_printed takes f_u = J h for an acceleration, as (36) and (37) do, with the signs of J put right, on preset
paper, open loop (errors in rad/s²); corrected has f_u = I⁻¹ Jᵀ h, on preset physical, whose position controller adds to
the paper's torques (errors as joint torque, N·m). Noise in both: Gaussian, 0.01 rad/s on velocity, at 1 kHz.

Every observer of patella-study-observers is tuned by its rule on seeds 101 and up and measured on seeds 1 and up. The
network (features φ, φ̇ and t; target: the offline smoother in torque space, tuned likewise) is trained on half of each
of the same recordings and tested on the other half, against the truth: steps by lot as in the paper, blocks of 5 s by
lot, or the second half; that of the random split also on other motions. It is tested as the loop runs it, step by step.

Results are kept in OUT/kept, one file each: a run that was interrupted goes on where it stopped, and one with more
seeds trains only what is new.)";

struct Arguments {
  PaperOptions options;
  std::vector<int> experiments{1, 2};
  std::vector<std::string> forms{"as_printed", "corrected"};
  std::vector<std::string> splits{"random", "blocked", "chronological"};
  bool only_networks = false;
  bool only_observers = false;
  bool quiet = false;
  std::string out = "paper";
};

void declareStudy(CLI::App& app, Arguments& a) {
  PaperOptions& o = a.options;
  app.add_option("--out", a.out, "folder for table1.md, table1.csv, the figures and what is kept")
      ->capture_default_str();
  app.add_option("--experiments", a.experiments)
      ->delimiter(',')
      ->check(patella::options::wholeNumberFrom(1, 2))
      ->capture_default_str();
  app.add_option("--forms", a.forms)
      ->delimiter(',')
      ->check(CLI::IsMember({"as_printed", "corrected"}))
      ->capture_default_str();
  app.add_option("--splits", a.splits)
      ->delimiter(',')
      ->check(CLI::IsMember({"random", "blocked", "chronological"}))
      ->capture_default_str();
  app.add_option("--seeds", o.seeds, "measured on, from 1")
      ->check(patella::options::wholeNumberFrom(1, 100))
      ->capture_default_str();
  app.add_option("--tuning-seeds", o.tuning_seeds, "tuned on, from 101")
      ->check(patella::options::wholeNumberFrom(1, 20))
      ->capture_default_str();
  app.add_option("--seconds", o.seconds, "length of a recording")
      ->check(patella::options::numberFrom(20.0, 600.0))
      ->capture_default_str();
  app.add_option("--rate-Hz", o.rate_Hz, "of the network, a whole part of 1000")
      ->check([](const std::string& text) {
        double rate_Hz = 0.0;
        const bool whole = CLI::detail::lexical_cast(text, rate_Hz) && rate_Hz >= 1.0 && rate_Hz <= 1000.0 &&
                           std::fmod(1000.0, rate_Hz) == 0.0;
        return whole ? "" : "value " + text + ", expected a whole part of 1000, like 100";
      })
      ->capture_default_str();
  CLI::Option* networks = app.add_flag("--only-networks", a.only_networks, "leave the observers out");
  app.add_flag("--only-observers", a.only_observers, "leave the networks out")->excludes(networks);
  app.add_flag("--kept-only", o.kept_only, "measure and train nothing: tables and figures of what is kept");
  app.add_flag("--quiet", a.quiet, "no progress");
}

void declareTraining(CLI::App& app, train::TrainingOptions& t) {
  app.add_option("--layers", t.layers, "of the LSTM, 1 or 2")->capture_default_str();
  app.add_option("--hidden", t.hidden, "width of each")->capture_default_str();
  app.add_option("--channels", t.channels)->capture_default_str();
  app.add_option("--heads", t.heads)->capture_default_str();
  app.add_option("--window", t.window, "steps that attention sees")->capture_default_str();
  app.add_option("--epochs", t.epochs)->capture_default_str();
  app.add_option("--batch", t.batch, "pieces in a step of the optimiser")->capture_default_str();
  app.add_option("--sequence-steps", t.sequence_steps, "of a piece")->capture_default_str();
  app.add_option("--burn-in", t.burn_in, "first of them, which only fill the memory")->capture_default_str();
  app.add_option("--learning-rate", t.learning_rate)->capture_default_str();
  app.add_option("--turn-s", t.turn_s, "within which a gate of the fresh network turns")
      ->capture_default_str();
  app.add_option("--threads", t.threads)->capture_default_str();
}

template <typename Value>
bool has(const std::vector<Value>& values, const Value& wanted) {
  return std::find(values.begin(), values.end(), wanted) != values.end();
}

void understand(Arguments& a) {
  PaperOptions& o = a.options;
  for (const bool corrected : {false, true}) {
    for (const int experiment : {1, 2}) {
      if (has<std::string>(a.forms, corrected ? "corrected" : "as_printed") &&
          has(a.experiments, experiment)) {
        o.conditions.push_back(
            {.experiment = experiment == 1 ? sim::PaperExperiment::kFirst : sim::PaperExperiment::kSecond,
             .noise = Noise::kVelocity,
             .corrected = corrected});
      }
    }
  }
  const std::vector<std::string>& names = train::splitNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (has(a.splits, names[i]) && !a.only_observers) {
      o.splits.push_back(static_cast<train::SplitKind>(i));
    }
  }
  o.observers = !a.only_networks;
  o.folder = std::filesystem::path(a.out) / "kept";
  checked(o.training);
}

void run(const Arguments& a) {
  const std::filesystem::path out = a.out;
  const auto tell = [&](const std::string& line) {
    if (!a.quiet) {
      std::cerr << line << std::flush;
    }
  };
  const PaperResults results = paperStudy(a.options, tell);
  const std::string text = table1(results) + "\n" + meaning(results);
  std::cout << text << std::flush;
  patella::app::writeFile(out / "table1.md", text);
  writeTable1(results, out / "table1.csv");
  drawFigures(a.options, results, out);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  Arguments arguments;
  arguments.options.training = {.window = 16,
                                .initialisation = train::Initialisation::kSpread,
                                .turn_s = 0.5,
                                .stopping = train::Stopping::kNone,
                                .epochs = 200,
                                .batch = 8,
                                .sequence_steps = 64,
                                .burn_in = 16,
                                .learning_rate = 5e-3};
  CLI::App app(kDescription, "patella-study-paper");
  declareStudy(app, arguments);
  declareTraining(app, arguments.options.training);
  return patella::options::runProgram(app, argc, argv, [&] {
    understand(arguments);
    run(arguments);
  });
}
