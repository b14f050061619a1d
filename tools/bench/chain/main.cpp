// patella-bench-chain: what the terms of a serial chain cost, beside Orocos KDL.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <random>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "core/model/serial_chain.hpp"
#include "firmware_app/files/urdf_file.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tools/bench/chain/kdl_peer.hpp"
#include "tools/bench/chain/robots.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using namespace patella;

constexpr const char* kDescription =
    R"(What inertia matrix, velocity torque and gravity torque of a serial chain cost together, beside KDL's ChainDynParam
on the same chains of URDF files. In every round each has its turn at the same states; one evaluation is timed at a time,
and the clock's own cost taken off. The ratio is that of the medians, KDL's to this project's.)";

struct Arguments {
  std::filesystem::path data;
  int rounds = 50;
  int states = 200;
  unsigned seed = 1;
};

using Clock = std::chrono::steady_clock;

double nsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::nano>(to - from).count();
}

double quantile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double costOfClock_ns() {
  std::vector<double> spans;
  for (int i = 0; i < 10'000; ++i) {
    const auto from = Clock::now();
    spans.push_back(nsBetween(from, Clock::now()));
  }
  return quantile(spans, 0.5);
}

struct Timed {
  std::vector<double> spans_ns;
  std::uint64_t allocations = 0;
};

/// One turn: `run(i)` for every state.
template <typename Run>
void turn(Timed& timed, int states, double clock_ns, Run&& run) {
  const std::size_t first = timed.spans_ns.size();
  timed.spans_ns.resize(first + static_cast<std::size_t>(states));
  const app::CountAllocations heap;
  for (int i = 0; i < states; ++i) {
    const auto from = Clock::now();
    run(static_cast<std::size_t>(i));
    timed.spans_ns[first + static_cast<std::size_t>(i)] = nsBetween(from, Clock::now()) - clock_ns;
  }
  timed.allocations += heap.counts().allocations;
}

void compare(const bench::Robot& robot, const Arguments& arguments, double clock_ns) {
  const std::string text = bench::urdfText(arguments.data, robot);
  model::SerialChainParameters parameters;
  parameters.links = app::parseUrdfChain(text, robot.file, robot.base, robot.tip);
  const model::SerialChain chain(parameters);
  bench::KdlPeer kdl(text, robot.base, robot.tip, parameters.gravity_m_s2);

  std::mt19937 random(arguments.seed);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  std::vector<JointVector> q, dq;
  for (int i = 0; i < arguments.states; ++i) {
    for (auto* vectors : {&q, &dq}) {
      vectors->emplace_back(chain.joints());
      std::generate_n(vectors->back().data(), chain.joints(), [&] { return uniform(random); });
    }
  }
  Timed own, theirs;
  double sum = 0.0;
  for (int round = 0; round < arguments.rounds; ++round) {
    turn(own, arguments.states, clock_ns, [&](std::size_t i) {
      const model::ChainTerms terms = chain.terms(q[i], dq[i]);
      sum += terms.inertia(0, 0) + terms.velocity_Nm[0] + terms.gravity_Nm[0];
    });
    turn(theirs, arguments.states, clock_ns, [&](std::size_t i) {
      kdl.setState(q[i], dq[i]);
      kdl.evaluate();
      sum -= kdl.inertia()(0, 0) + kdl.velocity_Nm()[0] + kdl.gravity_Nm()[0];
    });
  }
  const auto evaluations = static_cast<double>(own.spans_ns.size());
  const double median = quantile(own.spans_ns, 0.5);
  const double of_kdl = quantile(theirs.spans_ns, 0.5);
  fmt::print("{:<16}{:>7}{:>10.0f}{:>8.0f}{:>9.1f}{:>10.0f}{:>8.0f}{:>9.1f}{:>8.2f}\n", robot.name,
             chain.joints(), median, quantile(own.spans_ns, 0.99),
             static_cast<double>(own.allocations) / evaluations, of_kdl, quantile(theirs.spans_ns, 0.99),
             static_cast<double>(theirs.allocations) / evaluations, of_kdl / median);
  if (!(std::abs(sum) < 1e-3)) {
    fmt::print(stderr, "{}: the two differ by {:g}\n", robot.name, sum);
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(kDescription, "patella-bench-chain");
  Arguments arguments;
  app.add_option("--data", arguments.data, "folder of the URDF files")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--rounds", arguments.rounds, "turns of each")
      ->check(patella::options::wholeNumberFrom(1, 100'000))
      ->capture_default_str();
  app.add_option("--states", arguments.states, "evaluations a turn")
      ->check(patella::options::wholeNumberFrom(1, 100'000))
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "of the states")->capture_default_str();
  return patella::options::runProgram(app, argc, argv, [&] {
    const double clock_ns = costOfClock_ns();
    fmt::print(
        "seed {}, {} rounds of {} evaluations each; a reading of the clock, {:.0f} ns, is taken off\n\n",
        arguments.seed, arguments.rounds, arguments.states, clock_ns);
    fmt::print("{:<16}{:>7}{:>27}{:>27}{:>8}\n", "", "", "Patella, ns", "KDL, ns", "");
    fmt::print("{:<16}{:>7}{:>10}{:>8}{:>9}{:>10}{:>8}{:>9}{:>8}\n", "chain", "joints", "median", "p99",
               "allocs", "median", "p99", "allocs", "ratio");
    for (const bench::Robot& robot : bench::robots()) {
      compare(robot, arguments, clock_ns);
    }
  });
}
