// Split of recordings into training, validation and test.
#include "tools/train/split.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tools/train/spread_gates.hpp"
#include "tools/train/windows.hpp"

using namespace patella;
using namespace patella::train;

namespace {

std::vector<Sequence> empty(int count, Eigen::Index steps) {
  std::vector<Sequence> sequences(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    sequences[i].name = "run " + std::to_string(i);
    sequences[i].rate_Hz = 100.0;
    sequences[i].features = Rows::Zero(steps, 1);
    sequences[i].reference = Rows::Zero(steps, 1);
    sequences[i].observer = Rows::Zero(steps, 1);
    sequences[i].role.assign(static_cast<std::size_t>(steps), Role::kIgnored);
  }
  return sequences;
}

std::size_t distanceToTraining(const std::vector<Role>& roles, std::size_t step) {
  std::size_t distance = roles.size();
  for (std::size_t i = 0; i < roles.size(); ++i) {
    if (roles[i] == Role::kTrain) {
      distance = std::min(distance, i > step ? i - step : step - i);
    }
  }
  return distance;
}

}  // namespace

TEST_CASE("shares are kept, ends are left out, and the lot is the seed's") {
  for (const SplitKind kind :
       {SplitKind::kRandom, SplitKind::kBlocked, SplitKind::kChronological, SplitKind::kRecording}) {
    std::vector<Sequence> sequences = empty(10, 2000);
    const SplitOptions options{.kind = kind, .validation_share = 0.2, .test_share = 0.2, .block_s = 2.0};
    assignRoles(sequences, options);
    CHECK(countOf(sequences, Role::kTrain) == doctest::Approx(0.6 * 18000).epsilon(0.04));
    CHECK(countOf(sequences, Role::kTest) == doctest::Approx(0.2 * 18000).epsilon(0.3));
    CHECK(countOf(sequences, Role::kValidation) == doctest::Approx(0.2 * 18000).epsilon(0.3));
    CHECK(sequences[3].role[99] == Role::kIgnored);
    CHECK(sequences[3].role[1900] == Role::kIgnored);
    std::vector<Sequence> again = empty(10, 2000);
    assignRoles(again, options);
    CHECK(again[7].role == sequences[7].role);
  }
}

TEST_CASE("no tested step of a blocked split comes within the gap after a trained one") {
  std::vector<Sequence> sequences = empty(1, 6000);
  assignRoles(sequences, {.kind = SplitKind::kBlocked, .gap_s = 0.64});
  const std::vector<Role>& roles = sequences[0].role;
  std::size_t tested = 0;
  for (std::size_t step = 0; step < roles.size(); ++step) {
    if (roles[step] == Role::kTest) {
      ++tested;
      const auto past = roles.begin() + static_cast<std::ptrdiff_t>(step);
      CHECK(std::find(past - 64, past, Role::kTrain) == past);
    }
  }
  CHECK(tested > 300);
}

TEST_CASE("a random split puts every tested step between trained ones, a chronological one none") {
  std::vector<Sequence> sequences = empty(1, 3000);
  assignRoles(sequences, {.kind = SplitKind::kRandom});
  for (std::size_t step = 0; step < 3000; step += 7) {
    if (sequences[0].role[step] == Role::kTest) {
      CHECK(distanceToTraining(sequences[0].role, step) < 20);
    }
  }
  assignRoles(sequences, {.kind = SplitKind::kChronological});
  const auto& roles = sequences[0].role;
  const auto first_test = std::find(roles.begin(), roles.end(), Role::kTest);
  CHECK(std::find(first_test, roles.end(), Role::kTrain) == roles.end());
}

TEST_CASE("a share that whole recordings cannot give is refused") {
  std::vector<Sequence> sequences = empty(1, 3000);
  CHECK_THROWS_WITH_AS(assignRoles(sequences, {.kind = SplitKind::kRecording}),
                       doctest::Contains("no step is left for validation"), std::invalid_argument);
}

TEST_CASE("every trained step is learned from once in a pass, and its burn-in comes before it") {
  std::vector<Sequence> sequences = empty(3, 1000);
  for (Sequence& sequence : sequences) {
    assignRole(sequence, Role::kTrain, 0.0);
  }
  sim::Random random(4);
  std::vector<int> seen(3000);
  for (const Window& window : drawWindows(sequences, 96, 32, random)) {
    CHECK(window.count <= 96);
    CHECK(window.burn_in == (window.begin == 0 ? 0 : 32));
    for (Eigen::Index step = window.burn_in; step < window.count; ++step) {
      ++seen[1000 * window.sequence + static_cast<std::size_t>(window.begin + step)];
    }
  }
  CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times >= 1 && times <= 2; }));
  CHECK(std::count(seen.begin(), seen.end(), 2) <
        3 * 64);  // where the first piece, without burn-in, is short
}

TEST_CASE("spread gates turn all over the trained steps, as fast as was asked for") {
  std::vector<Sequence> sequences = empty(1, 5000);
  sequences[0].features.resize(5000, 2);
  for (Eigen::Index step = 0; step < 5000; ++step) {
    sequences[0].features.row(step) << std::sin(0.05 * static_cast<double>(step)),
        0.01 * static_cast<double>(step);
  }
  assignRole(sequences[0], Role::kTrain, 1.0);
  constexpr Eigen::Index kHidden = 64;
  const auto drawn = [&](double turn_s, std::uint64_t seed) {
    network::NetworkWeights weights =
        frameOf(sequences, {"q1_rad", "time_s"}, network::OutputKind::kAcceleration);
    weights.lstm.push_back({.weight_ih = network::WeightMatrix::Ones(4 * kHidden, 2),
                            .weight_hh = network::WeightMatrix::Zero(4 * kHidden, kHidden),
                            .bias_ih = network::WeightVector::Ones(4 * kHidden),
                            .bias_hh = network::WeightVector::Zero(4 * kHidden)});
    spreadGates(weights, sequences, turn_s, seed);
    return weights;
  };
  const network::NetworkWeights weights = drawn(2.0, 1);
  const network::LstmWeights& lstm = weights.lstm.front();
  CHECK(lstm.weight_ih.middleRows(kHidden, kHidden).isZero());  // forget gates
  CHECK(lstm.bias_ih.segment(kHidden, kHidden).isZero());
  const Eigen::VectorXd by_time = lstm.weight_ih.col(1).cast<double>() / weights.feature_scale[1];
  CHECK(by_time.cwiseAbs().maxCoeff() <= 0.5);
  CHECK(by_time.cwiseAbs().maxCoeff() > 0.45);
  // Where a candidate turns if the other feature stands at its mean: early and late, not at the middle alone.
  int early = 0;
  int late = 0;
  for (Eigen::Index row = 2 * kHidden; row < 3 * kHidden; ++row) {
    const double turn_s = weights.feature_mean[1] - static_cast<double>(lstm.bias_ih[row]) / by_time[row];
    early += turn_s < 15.0 ? 1 : 0;
    late += turn_s > 35.0 ? 1 : 0;
  }
  CHECK(early > kHidden / 8);
  CHECK(late > kHidden / 8);
  CHECK(drawn(2.0, 1).lstm[0].bias_ih == lstm.bias_ih);
  CHECK_FALSE(drawn(2.0, 2).lstm[0].bias_ih == lstm.bias_ih);
  assignRole(sequences[0], Role::kTest, 1.0);
  network::NetworkWeights untrained = weights;
  CHECK_THROWS_AS(spreadGates(untrained, sequences, 2.0, 1), std::invalid_argument);
}
