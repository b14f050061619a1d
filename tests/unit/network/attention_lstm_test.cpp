// Properties that the loop relies on: right numbers, the same bits whatever the calling pattern, no heap.
#include "core/network/attention_lstm.hpp"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <utility>

#include <doctest/doctest.h>

#include "tests/unit/network/loop_reference.hpp"
#include "tests/unit/network/random_network.hpp"

namespace {
std::atomic<long> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  void* memory = nullptr;
  if (posix_memalign(&memory, std::max(alignment, sizeof(void*)), size) != 0)
    throw std::bad_alloc();
  return memory;
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace patella::network {

namespace {

enum class Pattern { kOnePhase, kTwoPhase, kPrepareTwice };

Eigen::MatrixXd run(AttentionLstm& network, const Eigen::MatrixXd& features, Pattern pattern) {
  Eigen::MatrixXd outputs(features.rows(), network.outputs());
  for (Eigen::Index step = 0; step < features.rows(); ++step) {
    const Eigen::VectorXd row = features.row(step);
    outputs.row(step) = network.step({row.data(), static_cast<std::size_t>(row.size())});
    if (pattern != Pattern::kOnePhase)
      network.prepare();
    if (pattern == Pattern::kPrepareTwice)
      network.prepare();
  }
  return outputs;
}

RandomNetworkOptions smallNetwork(int layers) {
  RandomNetworkOptions options;
  options.shape = {.inputs = 4, .hidden = 11, .layers = layers, .channels = 12, .outputs = 2};
  options.heads = 3;
  options.window = 9;
  options.gain = 2.0;
  return options;
}

}  // namespace

TEST_CASE("streaming equals the equations written out in double") {
  for (const int layers : {1, 2})
    for (const int outputs : {1, 2})
      for (const int window : {1, 9, 32, 33, 400})
        for (const AttentionScale scale : {AttentionScale::kInvSqrt, AttentionScale::kNone}) {
          CAPTURE(layers);
          CAPTURE(outputs);
          CAPTURE(window);
          RandomNetworkOptions options = smallNetwork(layers);
          options.shape.outputs = outputs;
          options.window = window;
          options.attention_scale = scale;
          const NetworkWeights weights = randomNetwork(options);
          const Eigen::MatrixXd features = randomFeatures(weights, 150, 7);
          AttentionLstm network(weights);
          const Eigen::MatrixXd expected = loopReference(weights, features);
          CHECK((run(network, features, Pattern::kOnePhase) - expected).cwiseAbs().maxCoeff() < 1e-6);
          CHECK((expected.colwise().maxCoeff() - expected.colwise().minCoeff()).minCoeff() > 0.01);
        }
}

TEST_CASE("streaming equals the equations for any number of heads") {
  for (const int heads : {1, 2, 3, 5, 6, 8, 9, 20})
    for (const int window : {1, 7, 64}) {
      CAPTURE(heads);
      CAPTURE(window);
      RandomNetworkOptions options = smallNetwork(1);
      options.heads = heads;
      options.shape.channels = 3 * heads;
      options.window = window;
      const NetworkWeights weights = randomNetwork(options);
      const Eigen::MatrixXd features = randomFeatures(weights, 150, 7);
      AttentionLstm network(weights);
      CHECK((run(network, features, Pattern::kOnePhase) - loopReference(weights, features))
                .cwiseAbs()
                .maxCoeff() < 1e-6);
    }
}

TEST_CASE("the linear path adds what the equations say, from the first step on") {
  for (const std::vector<int>& lags : {std::vector{0}, std::vector{0, 1}, std::vector{0, 2, 3, 40}})
    for (const int outputs : {1, 2}) {
      CAPTURE(lags.back());
      RandomNetworkOptions options = smallNetwork(1);
      options.shape.outputs = outputs;
      options.linear_bound = outputs == 1 ? 1e3F : 1.5F;  // passed again and again
      const NetworkWeights without = randomNetwork(options);
      options.linear_lags = lags;
      const NetworkWeights weights = randomNetwork(options);
      const Eigen::MatrixXd features = randomFeatures(weights, 150, 7);
      const Eigen::MatrixXd expected = loopReference(weights, features);
      AttentionLstm network(weights);
      CHECK((run(network, features, Pattern::kTwoPhase) - expected).cwiseAbs().maxCoeff() < 1e-6);
      CHECK((loopReference(without, features) - expected).colwise().norm().minCoeff() > 1.0);
    }
}

TEST_CASE("no features push the linear path beyond its bound, and it comes back as they leave") {
  RandomNetworkOptions options = smallNetwork(1);
  options.linear_lags = {0, 2, 3, 40};
  const NetworkWeights unbounded = randomNetwork(options);
  Eigen::MatrixXd features = randomFeatures(unbounded, 300, 7);
  NetworkWeights silent = unbounded;
  silent.linear_weight.setZero();
  AttentionLstm free(unbounded);
  AttentionLstm rest(silent);
  const Eigen::MatrixXd linear =
      run(free, features, Pattern::kTwoPhase) - run(rest, features, Pattern::kTwoPhase);
  NetworkWeights weights = unbounded;
  weights.linear_bound =
      (1.01 * linear.cwiseAbs().colwise().maxCoeff().transpose().cwiseQuotient(weights.output_scale))
          .cast<float>();

  AttentionLstm bounded(weights);
  free.reset();
  CHECK(run(bounded, features, Pattern::kTwoPhase) == run(free, features, Pattern::kTwoPhase));

  const Eigen::RowVectorXd bound =
      weights.linear_bound.cast<double>().cwiseProduct(weights.output_scale).transpose();
  for (const double wild : {1.0, 30.0, -1e6, 1e35}) {
    CAPTURE(wild);
    Eigen::MatrixXd disturbed = features;
    disturbed(150, 1) += wild * weights.feature_scale[1];
    bounded.reset();
    rest.reset();
    const Eigen::MatrixXd said =
        run(bounded, disturbed, Pattern::kTwoPhase) - run(rest, disturbed, Pattern::kTwoPhase);
    CHECK((said.cwiseAbs().rowwise() - bound).maxCoeff() < 1e-6);
    CHECK((said - linear).topRows(150).isZero(1e-6));
    CHECK((said - linear).bottomRows(300 - 150 - 81).isZero(1e-6));
    if (std::abs(wild) > 10.0)
      CHECK(said.row(150).isZero(0.0));
  }
}

TEST_CASE("a feature that overflows the linear path silences it alone") {
  RandomNetworkOptions options = smallNetwork(1);
  options.linear_lags = {0, 1};
  NetworkWeights weights = randomNetwork(options);
  weights.lstm[0].weight_ih.setZero();
  weights.linear_weight.setConstant(1e3F);
  weights.linear_weight.col(1).setConstant(-1e3F);
  NetworkWeights silent = weights;
  silent.linear_weight.setZero();
  Eigen::MatrixXd features = randomFeatures(weights, 10, 7);
  features.row(4) = (1e37 * weights.feature_scale + weights.feature_mean).transpose();
  AttentionLstm network(weights);
  AttentionLstm rest(silent);
  const Eigen::MatrixXd outputs = run(network, features, Pattern::kTwoPhase);
  CHECK(outputs.allFinite());
  CHECK(outputs.middleRows(4, 2) == run(rest, features, Pattern::kTwoPhase).middleRows(4, 2));
}

TEST_CASE("when prepare() is called, and which variant runs, does not change a bit") {
  for (const Precision precision : {Precision::kFloat32, Precision::kInt16})
    for (const int layers : {1, 2})
      for (const int heads : {8, 2}) {
        RandomNetworkOptions options;
        options.shape.layers = layers;
        options.heads = heads;
        if (layers == 2) {
          options.linear_lags = {0, 3, 20};
          options.linear_bound = 0.7F;
        }
        const NetworkWeights weights = randomNetwork(options);
        const Eigen::MatrixXd features = randomFeatures(weights, 100, 8);
        AttentionLstm widest(weights, {.precision = precision});
        const Eigen::MatrixXd expected = run(widest, features, Pattern::kOnePhase);
        for (const InstructionSet set : availableInstructionSets()) {
          CAPTURE(nameOf(set));
          AttentionLstm network(weights, {.instruction_set = set, .precision = precision});
          for (const Pattern pattern : {Pattern::kOnePhase, Pattern::kTwoPhase, Pattern::kPrepareTwice}) {
            network.reset();
            CHECK(run(network, features, pattern) == expected);
          }
        }
      }
}

TEST_CASE("reset() returns to the beginning, bit for bit") {
  RandomNetworkOptions options = smallNetwork(2);
  options.linear_lags = {0, 7};
  options.linear_bound = 0.2F;  // at the end it is not believed
  const NetworkWeights weights = randomNetwork(options);
  const Eigen::MatrixXd features = randomFeatures(weights, 100, 9);
  AttentionLstm network(weights);
  const Eigen::MatrixXd first = run(network, features, Pattern::kTwoPhase);
  const Eigen::MatrixXd carried_on = run(network, features, Pattern::kTwoPhase);
  network.reset();
  CHECK(run(network, features, Pattern::kTwoPhase) == first);
  CHECK(carried_on.row(0) != first.row(0));

  AttentionLstm moved = std::move(network);
  moved.reset();
  CHECK(run(moved, features, Pattern::kOnePhase) == first);
}

TEST_CASE("what lies W steps back no longer matters to the attention") {
  RandomNetworkOptions options = smallNetwork(1);
  NetworkWeights weights = randomNetwork(options);
  // Without recurrence and with closed forget gates the past enters through the attention alone.
  weights.lstm[0].weight_hh.setZero();
  weights.lstm[0].weight_ih.middleRows(11, 11).setZero();
  weights.lstm[0].bias_ih.segment(11, 11).setConstant(-200.0F);
  const Eigen::MatrixXd features = randomFeatures(weights, 3 * options.window, 10);
  const int event = options.window + 4;
  Eigen::MatrixXd changed = features;
  changed.row(event) += 2.0 * weights.feature_scale.transpose();
  AttentionLstm network(weights);
  AttentionLstm other(weights);
  const Eigen::MatrixXd difference =
      run(network, features, Pattern::kOnePhase) - run(other, changed, Pattern::kOnePhase);
  CHECK(difference.topRows(event).isZero(0.0));
  for (int step = event; step < event + options.window; ++step)
    CHECK(difference.row(step).cwiseAbs().maxCoeff() > 1e-4);
  CHECK(difference.bottomRows(features.rows() - event - options.window).isZero(1e-12));
}

TEST_CASE("unusable features give NaN and leave the past as it was") {
  RandomNetworkOptions options = smallNetwork(1);
  options.linear_lags = {0, 1, 5};
  const NetworkWeights weights = randomNetwork(options);
  const Eigen::MatrixXd features = randomFeatures(weights, 40, 11);
  AttentionLstm network(weights);
  AttentionLstm undisturbed(weights);
  CHECK(run(network, features, Pattern::kTwoPhase) == run(undisturbed, features, Pattern::kTwoPhase));
  Eigen::VectorXd bad = features.row(0);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    bad[2] = value;
    CHECK(network.step({bad.data(), 4}).array().isNaN().all());
  }
  CHECK(network.step({bad.data(), 3}).array().isNaN().all());
  CHECK(run(network, features, Pattern::kTwoPhase) == run(undisturbed, features, Pattern::kTwoPhase));
}

TEST_CASE("a large mean beside a small scale costs no digits") {
  NetworkWeights weights = randomNetwork(smallNetwork(1));
  const Eigen::MatrixXd features = randomFeatures(weights, 60, 12);
  AttentionLstm network(weights);
  const Eigen::MatrixXd expected = run(network, features, Pattern::kOnePhase);
  weights.feature_mean.array() += 1e6;
  AttentionLstm shifted(weights);
  const Eigen::MatrixXd outputs = run(shifted, features.array() + 1e6, Pattern::kOnePhase);
  CHECK((outputs - expected).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("steps, prepare and reset do not touch the heap") {
  RandomNetworkOptions options;
  options.linear_lags = {0, 1, 60};
  const NetworkWeights weights = randomNetwork(options);
  const Eigen::MatrixXd features = randomFeatures(weights, 200, 13).transpose();
  for (const InstructionSet set : availableInstructionSets())
    for (const Precision precision : {Precision::kFloat32, Precision::kInt16}) {
      AttentionLstm network(weights, {.instruction_set = set, .precision = precision});
      double sum = 0.0;
      const long before = allocations;
      Eigen::internal::set_is_malloc_allowed(false);
      for (Eigen::Index step = 0; step < features.cols(); ++step) {
        sum += network.step({features.col(step).data(), 5}).sum();
        network.prepare();
      }
      network.reset();
      Eigen::internal::set_is_malloc_allowed(true);
      CHECK(allocations == before);
      CHECK(before > 0);
      CHECK(std::isfinite(sum));
    }
}

}  // namespace patella::network
