// patella-bench-plan: how much more a planned motion reveals than the best single sine, on drawn machines.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/bench/diagnose/in_parallel.hpp"
#include "tools/bench/plan/comparison.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using namespace patella::bench;

struct Options {
  std::size_t machines = 50;
  std::size_t first = 1;
  std::uint64_t seed = 1;
  unsigned threads = 2;
  CompareOptions compare;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

// Ratios of the sine's sizes to the plan's, and to what no motion exceeds.
struct Factors {
  std::vector<double> planned, possible;

  std::string cells() const {
    constexpr double kThree = 3.0;
    const auto of_three = [](double factor) { return factor >= kThree; };
    return fmt::format("{} | {:.3g} | {:.3g} | {} | {}", planned.size(), median(planned),
                       *std::min_element(planned.begin(), planned.end()),
                       std::count_if(planned.begin(), planned.end(), of_three),
                       std::count_if(possible.begin(), possible.end(), of_three));
  }
};

void print(const std::vector<Comparison>& all, std::size_t first) {
  std::cout
      << "| no | machine | effect | sine | planned | factor | at most | range, speed, torque in % | s |\n"
         "|---|---|---|---|---|---|---|---|---|\n";
  std::map<std::string, Factors> factors;
  int broken = 0;
  double slowest_s = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Comparison& one = all[i];
    std::cout << fmt::format(
        "| {} | {} | {} | {:.3g} | {:.3g} | {:.3g} | {:.3g} | {:.0f}, {:.0f}, {:.0f} | {:.1f} |\n", first + i,
        one.machine, one.effect, one.sine, one.planned, one.factor(), one.possible(), 100.0 * one.taken.range,
        100.0 * one.taken.speed, 100.0 * one.taken.torque, one.seconds);
    for (const std::string& group :
         {std::string("all"), one.machine, one.effect.substr(0, one.effect.find('@'))}) {
      factors[group].planned.push_back(one.factor());
      factors[group].possible.push_back(one.possible());
    }
    broken += one.taken.broken();
    slowest_s = std::max(slowest_s, one.seconds);
  }
  std::cout << "\n| of | number | median factor | smallest factor | at least 3 | possible |\n"
               "|---|---|---|---|---|---|\n";
  for (const auto& [group, values] : factors) {
    std::cout << fmt::format("| {} | {} |\n", group, values.cells());
  }
  std::cout << fmt::format("\n{} limits broken in {} simulations. Slowest plan {:.1f} s.\n", broken,
                           all.size(), slowest_s);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Compares planned motions with the best single sine of 0.5 Hz of the same duration, limits and start, "
      "for the effect that this sine shows least. Factor: smallest size that the sine reveals over that of "
      "the plan; at most: the same of the best motion that could be, which is no more than that. Each plan "
      "is then followed by the machine, with masses up to 5 % off and the effect hidden.",
      "patella-bench-plan");
  Options options;
  app.add_option("--machines", options.machines, "number of drawn machines")
      ->check(patella::options::wholeNumberFrom(1, 100000))
      ->capture_default_str();
  app.add_option("--first", options.first, "number of the first of them")
      ->check(patella::options::wholeNumberFrom(1, 100000))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of machine 1")->capture_default_str();
  app.add_option("--threads", options.threads, "at once")
      ->check(patella::options::wholeNumberFrom(1, 256))
      ->capture_default_str();
  app.add_option("--duration", options.compare.duration_s, "s of motion")
      ->check(patella::options::numberFrom(8.0, 120.0))
      ->capture_default_str();
  app.add_option("--dry-friction", options.compare.dry_friction,
                 "of each joint, declared in its model, as a share of its torque limit")
      ->check(patella::options::numberFrom(0.0, 0.2))
      ->capture_default_str();
  app.add_option("--evaluations", options.compare.evaluations, "motions that each search looks at")
      ->check(patella::options::wholeNumberFrom(100, 1000000))
      ->capture_default_str();
  app.add_option(
         "--nominal-tolerance", options.compare.nominal_tolerance,
         "relative, by which the model's parameters may be wrong; 1: hardly anything is known of them")
      ->check(patella::options::numberFrom(1e-4, 1.0))
      ->capture_default_str();
  return patella::options::runProgram(app, argc, argv, [&] {
    std::vector<Comparison> all(options.machines);
    std::mutex mutex;
    std::size_t done = 0;
    inParallel(options.threads, options.machines, [&](std::size_t i) {
      all[i] = compare(drawMachine(options.seed * 1000 + options.first - 1 + i), options.compare);
      const std::lock_guard lock(mutex);
      std::fprintf(stderr, "%zu of %zu: %s, factor %.3g\n", ++done, options.machines, all[i].machine.c_str(),
                   all[i].factor());
    });
    print(all, options.first);
  });
}
