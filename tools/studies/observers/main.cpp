// patella-study-observers: every observer of core/estimation at the same noise, in the paper's two
// experiments.
#include <filesystem>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"
#include "tools/studies/observers/study.hpp"

namespace {

constexpr const char* kDescription =
    R"(Mean |f_u − estimate| of every observer at the same noise, in the paper's experiments 1 and 2, and the delay
of each (largest cross-correlation with the truth).

Conditions, at 1 kHz: preset paper with Gaussian noise of 0.01 rad/s on velocity, or of 0.01 on both states, in
rad/s²; preset physical under position control, a 14-bit encoder without velocity and a torque that is off by 0.02 N·m
each step, as joint torque in N·m. The first second is left out, and the last. A causal estimate is held against the
truth of the sample at which it is given. Where a method needs a velocity that is not measured, it is derived from
position by the loop's filter, whose cutoff is one more number to tune.

Tuning, the same for every method in every condition, on seeds 101 and up, which are not measured on: a number is
multiplied or divided by a factor for as long as the mean error, summed over the joints, falls; both joints' values of
a number together, then each alone, then all numbers of a joint, for the factors 4, 2 and √2 in turn. What the table calls tuned is all that was
tuned; noise is told to the Kalman filters as it is.)";

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  using namespace patella::study;
  StudyOptions options;
  std::string out;
  CLI::App app(kDescription, "patella-study-observers");
  std::string noise;
  app.add_option("--noise", noise, "only this one of the three: velocity, both_states or encoder_only")
      ->check(CLI::IsMember({"velocity", "both_states", "encoder_only"}));
  app.add_option("--seconds", options.seconds, "length of each recording, s")
      ->capture_default_str()
      ->check(patella::options::numberFrom(4.0, 1000.0));
  app.add_option("--seeds", options.seeds, "measured on, from 1")
      ->capture_default_str()
      ->check(patella::options::wholeNumberFrom(1, 100));
  app.add_option("--tuning-seeds", options.tuning_seeds, "tuned on, from 101")
      ->capture_default_str()
      ->check(patella::options::wholeNumberFrom(1, 20));
  app.add_option("--jobs", options.jobs, "threads")
      ->capture_default_str()
      ->check(patella::options::wholeNumberFrom(1, 64));
  app.add_option("--out", out, "folder for observers.csv and observers.png");
  return patella::options::runProgram(app, argc, argv, [&] {
    if (!noise.empty()) {
      std::erase_if(options.conditions,
                    [&](const Condition& condition) { return noiseName(condition.noise) != noise; });
    }
    if (!out.empty()) {
      std::filesystem::create_directories(out);
    }
    const std::vector<Result> results = study(options);
    std::cout << tables(results);
    if (!out.empty()) {
      writeCsv(results, std::filesystem::path(out) / "observers.csv");
      draw(results, std::filesystem::path(out) / "observers.png");
    }
  });
}
