// patella-bench-diagnose: diagnosis on simulated rigs whose truth is known. How it is marked stands in
// score.hpp.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <time.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tools/bench/diagnose/asserted.hpp"
#include "tools/bench/diagnose/conventions.hpp"
#include "tools/bench/diagnose/draw_chain.hpp"
#include "tools/bench/diagnose/in_parallel.hpp"
#include "tools/bench/diagnose/planted.hpp"
#include "tools/bench/diagnose/summary.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using namespace patella;
using namespace patella::bench;
using Clock = std::chrono::steady_clock;

struct Options {
  std::size_t cases = 100;
  std::size_t first = 0;
  std::uint64_t seed = 1;
  std::string suite = "all";
  unsigned threads = 2;
  std::filesystem::path out;
  std::filesystem::path data;
  int replicates = diagnose::DiagnoseOptions{}.bootstrap_replicates;
  std::vector<std::string> without;  ///< gates
  bool recordings = false;
  bool draw_only = false;
  std::size_t mistakes = 1;
  Wish wish;
};

constexpr const char* kRules = R"(Rules
  named right   the verdict is effect_found, and choosing one alternative of each finding (its own kind, or an entry
                of indistinguishable_from) gives exactly the true effects on their joints; with at most two
                alternatives each. Larger sets are counted apart. Findings that may all be one effect instead name
                it together.
  false         a finding none of whose alternatives consists of true effects. Kinds count as they are called.
  unknown       right for an effect beyond the library; the variable is right where the strongest remaining
                dependence names one that the true torque depends on.
  strength      rms of the effect's torque below 10 Hz that no nominal parameter explains, over the rms of the noise.
  held-out      error over the true noise in the same band, joints together.
  Payload, rotor inertia of a first or only joint and torque gain of a single joint are what other nominal
  parameters would be: drawn in physical sizes and counted apart. So is viscous friction of less than a fifth of
  the damping that the model declares, which is within two standard deviations of it.
Suites: none, single, double, unknown, or all: of 20 cases 10 single, 4 none, 3 double, 3 unknown. And chain: the
  same on serial chains, each drawn with its axes, links and base. And defect: what
  breaks or wears on machines, one of eight kinds that nothing was tuned to. And planted:
  halves of measured recordings with the model that the other half led to, plain or with a drawn effect added to the
  measured torque. And conventions: measured recordings as they are and with one wrong convention each, with the
  makers' model, plain and with fitted friction. Named: refused with the right convention among those
  named; wrong: refused with others only.
Gates, which an effect passes before it is asserted: share, of the residual that anyone would miss; chance, by the
  family-wise p of a bootstrap; cross-validation, gain on folds that were not fitted; stability, gain on most block
  bootstraps; held-out, smaller error on the held-out part; rest, more torque than what nothing explains.)";

Suite suiteOf(const std::string& name, std::size_t index) {
  if (name == "all" || name == "chain") {
    constexpr std::size_t kCycle = 20, kSingles = 10, kNones = 14, kDoubles = 17;
    const std::size_t place = index % kCycle;
    return place < kSingles   ? Suite::kSingle
           : place < kNones   ? Suite::kNone
           : place < kDoubles ? Suite::kDouble
                              : Suite::kUnknown;
  }
  for (const Suite suite : {Suite::kNone, Suite::kSingle, Suite::kDouble, Suite::kDefect}) {
    if (suiteName(suite) == name) {
      return suite;
    }
  }
  return Suite::kUnknown;
}

constexpr std::array kGates{std::pair{"share", &diagnose::Gates::share},
                            std::pair{"chance", &diagnose::Gates::chance},
                            std::pair{"cross-validation", &diagnose::Gates::cross_validation},
                            std::pair{"stability", &diagnose::Gates::stability},
                            std::pair{"held-out", &diagnose::Gates::heldout},
                            std::pair{"rest", &diagnose::Gates::rest}};

diagnose::Gates gatesWithout(const std::vector<std::string>& names) {
  diagnose::Gates gates;
  for (const auto& [name, gate] : kGates) {
    gates.*gate = std::find(names.begin(), names.end(), name) == names.end();
  }
  return gates;
}

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of this thread; a diagnosis starts no other.
double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void saveCase(const Case& drawn, const std::filesystem::path& folder) {
  const std::string stem = drawn.run.recording.name;
  writeCsv(drawn.run, folder / (stem + ".csv"));
  std::string heading = "Model handed over with " + stem + ".csv, which lacks:";
  for (const CaseEffect& effect : drawn.effects) {
    heading += " " + effect.effect.label();
  }
  app::saveModel(drawn.nominal, folder / (stem + ".toml"), heading);
}

CaseResult runCase(const Options& options, std::size_t index) {
  constexpr std::uint64_t kCasesOfSeed = 1'000'000;
  const auto start = Clock::now();
  const Suite suite = suiteOf(options.suite, index);
  Case drawn = drawCase(options.seed * kCasesOfSeed + index, suite, options.wish);
  CaseResult result;
  result.seed = drawn.seed;
  result.suite = suite;
  result.mechanism = drawn.mechanism;
  result.motion = drawn.motion;
  result.duration_s = drawn.rig.duration_s;
  result.joints = drawn.rig.body.joints();
  result.effects = drawn.effects;
  result.truth = truthOf(drawn);
  result.simulating_s = secondsSince(start);
  if (options.recordings) {
    saveCase(drawn, options.out);
  }
  if (options.draw_only) {
    return result;
  }
  const auto diagnosing = Clock::now();
  const double begun_s = processorSeconds();
  try {
    diagnose::DiagnoseOptions how;
    how.seed = drawn.seed;
    how.bootstrap_replicates = options.replicates;
    how.gates = gatesWithout(options.without);
    how.person_Nm.assign(drawn.rig.human_Nm.begin(), drawn.rig.human_Nm.begin() + drawn.nominal.joints());
    result.diagnosis = diagnose::diagnose(std::span(&drawn.run.recording, 1), {}, drawn.nominal, how);
    keepAsserted(result.diagnosis);
    result.diagnosis.curves.clear();
    result.score = score(result.truth, result.diagnosis);
  } catch (const std::exception& error) {
    result.error = error.what();
    result.score.outcome = Outcome::kFailed;
  }
  result.diagnosing_s = secondsSince(diagnosing);
  result.processor_s = processorSeconds() - begun_s;
  return result;
}

// Cases one by one as threads get free; results in the order of the cases.
class Pool {
 public:
  explicit Pool(const Options& options) : options_(options), results_(options.cases) {
    if (!options.out.empty()) {
      std::filesystem::create_directories(options.out);
      table_.open(options.out / "results.csv");
      table_ << csvHeader();
    }
  }

  std::vector<CaseResult> run() {
    inParallel(options_.threads, options_.cases, [this](std::size_t i) {
      results_[i] = runCase(options_, options_.first + i);
      const std::lock_guard lock(mutex_);
      note(results_[i]);
    });
    return std::move(results_);
  }

 private:
  void note(const CaseResult& result) {
    ++done_;
    const std::string row = csvRow(result);
    if (table_.is_open()) {
      table_ << row << std::flush;
    }
    std::string truth;
    for (const CaseEffect& effect : result.effects) {
      truth += " " + effect.effect.label();
    }
    std::fprintf(stderr, "%zu of %zu: %s %llu%s: %s\n", done_, options_.cases,
                 std::string(suiteName(result.suite)).c_str(), static_cast<unsigned long long>(result.seed),
                 truth.c_str(),
                 !result.error.empty() ? result.error.c_str()
                 : options_.draw_only  ? "drawn"
                                       : std::string(outcomeName(result.score.outcome)).c_str());
  }

  const Options& options_;
  std::vector<CaseResult> results_;
  std::size_t done_ = 0;
  std::mutex mutex_;
  std::ofstream table_;
};

void runAll(const Options& options) {
  const std::vector<CaseResult> results = Pool(options).run();
  if (options.draw_only) {
    return;
  }
  const std::string summary = summaryText(results);
  std::cout << summary;
  if (!options.out.empty()) {
    app::writeFile(options.out / "summary.txt", summary);
    drawSummary(results, options.out);
    std::cout << "  results.csv, summary.txt and pictures in " << options.out.string() << "\n";
  }
}

// What the parser does not know: which options belong together.
void understand(Options& options) {
  if (options.suite == "chain" && options.wish.mechanism.empty()) {
    options.wish.mechanism = "chain";
  }
  if (options.wish.joints != 0 && options.wish.mechanism.find("chain") == std::string::npos) {
    throw std::invalid_argument(
        "--joints: belongs to chains: --suite chain, --mechanism chain or planar_chain");
  }
  const bool measured = options.suite == "planted" || options.suite == "conventions";
  if (measured == options.data.empty()) {
    throw std::invalid_argument("--data: belongs to the suites planted and conventions, which need it");
  }
  if (options.recordings && options.out.empty()) {
    throw std::invalid_argument("--recordings: needs --out");
  }
}

void runSuite(const Options& options) {
  if (options.suite == "planted") {
    std::cout << runPlanted({.data = options.data,
                             .source = checkout::source(),
                             .out = options.out,
                             .cases = options.cases,
                             .first = options.first,
                             .seed = options.seed,
                             .threads = options.threads});
  } else if (options.suite == "conventions") {
    std::cout << runConventions({.data = options.data,
                                 .source = checkout::source(),
                                 .out = options.out,
                                 .cases = options.cases,
                                 .seed = options.seed,
                                 .mistakes = options.mistakes,
                                 .judge_only = options.draw_only});
  } else {
    runAll(options);
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app("Diagnoses simulated rigs whose truth is known, and marks the answers.",
               "patella-bench-diagnose");
  app.footer(kRules);
  Options options;
  app.add_option("--cases", options.cases, "how many")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--seed", options.seed, "cases of different seeds have nothing in common")
      ->capture_default_str();
  app.add_option("--first", options.first, "number of the first case of the seed")->capture_default_str();
  app.add_option("--suite", options.suite, "what is missing")
      ->check(CLI::IsMember(
          {"single", "double", "none", "unknown", "defect", "all", "chain", "planted", "conventions"}))
      ->capture_default_str();
  app.add_option("--data", options.data,
                 "folder of measured recordings, for the suites planted and conventions")
      ->check(CLI::ExistingDirectory);
  app.add_option("--threads", options.threads, "cases at once")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--out", options.out, "folder for results.csv, which grows with the cases, and pictures");
  app.add_option("--without", options.without, "gates of the decision to leave open, see below")
      ->delimiter(',')
      ->check(CLI::IsMember({"share", "chance", "cross-validation", "stability", "held-out", "rest"}));
  app.add_option("--replicates", options.replicates, "of the bootstrap")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--only", options.wish.effect, "kind of effect");
  app.add_option("--mechanism", options.wish.mechanism,
                 "paper_leg, adult_leg, light_arm, knee, linear_axis, chain or planar_chain");
  app.add_option("--joints", options.wish.joints, "of chains, instead of 2 to 7")
      ->check(patella::options::wholeNumberFrom(kFewestJoints, kMostJoints));
  app.add_option("--motion", options.wish.motion, "multisine, gait or sine");
  app.add_option("--strength", options.wish.strength, "of each effect, instead of 0.5 to 5")
      ->check(options::positiveNumber());
  app.add_flag("--recordings", options.recordings, "leave each case's recording and model in --out as well");
  app.add_flag("--draw-only", options.draw_only,
               "diagnose nothing; of the suite conventions, judge the columns only");
  app.add_option("--mistakes", options.mistakes, "in each copy of the suite conventions, 1 or 2")
      ->check(patella::options::wholeNumberFrom(1, 2))
      ->capture_default_str();
  return patella::options::runProgram(app, argc, argv, [&] {
    understand(options);
    runSuite(options);
  });
}
