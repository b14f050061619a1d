// patella-bench-plan: how much more a planned motion reveals than the best single sine, on drawn machines.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/bench/diagnose/in_parallel.hpp"
#include "tools/bench/plan/comparison.hpp"

namespace {

using namespace patella::bench;

struct Options {
  std::size_t machines = 50;
  std::uint64_t seed = 1;
  unsigned threads = 2;
  CompareOptions compare;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

void print(const std::vector<Comparison>& all) {
  std::cout << fmt::format("| {:<4} | {:<10} | {:<58} | {:>6} | range, speed, torque in % | {:>5} |\n", "no",
                           "machine", "named: sine, planned", "factor", "s");
  std::cout << "|---|---|---|---|---|---|\n";
  std::map<std::string, std::vector<double>> by_machine;
  std::vector<double> factors, single;
  int broken = 0, beyond_sine = 0;
  double slowest_s = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Comparison& one = all[i];
    std::string named;
    for (const Compared& effect : one.named) {
      named += fmt::format("{}{}: {}{:.3g}, {:.3g}", named.empty() ? "" : "; ", effect.label,
                           effect.sine_never ? "> " : "", effect.sine, effect.planned);
      beyond_sine += effect.sine_never ? 1 : 0;
      single.push_back(effect.factor());
    }
    std::cout << fmt::format(
        "| {:<4} | {:<10} | {:<58} | {:>6.3g} | {:>3.0f}, {:>3.0f}, {:>3.0f} | {:>5.1f} |\n", i + 1,
        one.machine, named, one.factor, 100.0 * one.taken.range, 100.0 * one.taken.speed,
        100.0 * one.taken.torque, one.seconds);
    by_machine[one.machine].push_back(one.factor);
    factors.push_back(one.factor);
    broken += one.taken.broken();
    slowest_s = std::max(slowest_s, one.seconds);
  }
  std::cout
      << "\n| machines | number | median factor | smallest factor | at least 3 |\n|---|---|---|---|---|\n";
  by_machine["all"] = factors;
  for (const auto& [name, values] : by_machine) {
    std::cout << fmt::format("| {} | {} | {:.3g} | {:.3g} | {} |\n", name, values.size(), median(values),
                             *std::min_element(values.begin(), values.end()),
                             std::count_if(values.begin(), values.end(), [](double v) { return v >= 3.0; }));
  }
  std::cout << fmt::format(
      "\n{} single effects: median factor {:.3g}, smallest {:.3g}, at least 3 in {}; the sine never shows "
      "{}.\n"
      "{} limits broken in {} simulations. Slowest plan {:.1f} s.\n",
      single.size(), median(single), *std::min_element(single.begin(), single.end()),
      std::count_if(single.begin(), single.end(), [](double v) { return v >= 3.0; }), beyond_sine, broken,
      all.size(), slowest_s);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Compares planned motions with the best single sine of 0.5 Hz of the same duration, limits and start. "
      "Factor: smallest size that the sine reveals over that of the plan, for the effects that the sine "
      "shows "
      "least. Each plan is then followed by the machine, with masses up to 5 % off and these effects hidden.",
      "patella-bench-plan");
  Options options;
  app.add_option("--machines", options.machines, "number of drawn machines")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first machine")->capture_default_str();
  app.add_option("--threads", options.threads, "at once")->check(CLI::Range(1, 256))->capture_default_str();
  app.add_option("--duration", options.compare.duration_s, "s of motion")
      ->check(CLI::Range(8.0, 120.0))
      ->capture_default_str();
  app.add_option("--evaluations", options.compare.evaluations, "motions that each search looks at")
      ->check(CLI::Range(100, 1000000))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    std::vector<Comparison> all(options.machines);
    std::mutex mutex;
    std::size_t done = 0;
    inParallel(options.threads, options.machines, [&](std::size_t i) {
      all[i] = compare(drawMachine(options.seed * 1000 + i), options.compare);
      const std::lock_guard lock(mutex);
      std::fprintf(stderr, "%zu of %zu: %s, factor %.3g\n", ++done, options.machines, all[i].machine.c_str(),
                   all[i].factor);
    });
    print(all);
  } catch (const std::exception& error) {
    std::cerr << "patella-bench-plan: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
