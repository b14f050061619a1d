// A network in the tick: its estimate, its use, and the networks that are refused.
#include <cmath>

#include <doctest/doctest.h>

#include "core/network/network_weights.hpp"
#include "tests/unit/tick/simulated_leg.hpp"

using namespace patella;
using namespace patella::tick;
using safety::State;

namespace {

/// Weights of a network that says the same whatever it sees.
network::NetworkWeights constantWeights(const JointVector& value, const std::vector<std::string>& features) {
  network::NetworkWeights weights;
  weights.lstm.resize(1);
  weights.heads = 1;
  weights.window = 4;
  weights.features = features;
  const auto inputs = static_cast<Eigen::Index>(features.size());
  weights.feature_mean = Eigen::VectorXd::Zero(inputs);
  weights.feature_scale = Eigen::VectorXd::Ones(inputs);
  weights.output_mean = value;
  weights.output_scale = Eigen::VectorXd::Ones(value.size());
  visitTensors(weights, {.inputs = inputs, .hidden = 4, .layers = 1, .channels = 4, .outputs = value.size()},
               [](const std::string&, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 tensor = std::decay_t<decltype(tensor)>::Zero(rows, cols);
               });
  return weights;
}

Network networkOf(const network::NetworkWeights& weights, network::OutputKind output) {
  return {std::make_unique<network::AttentionLstm>(weights), weights.features, output};
}

Network constantNetwork(const JointVector& value, network::OutputKind output,
                        const std::vector<std::string>& features = {"q1_rad", "q2_rad"}) {
  return networkOf(constantWeights(value, features), output);
}

/// Its output grows with every step it takes, whatever it sees.
Network countingNetwork(network::OutputKind output) {
  network::NetworkWeights weights = constantWeights(pair(0.0, 0.0), {"q1_rad", "q2_rad"});
  weights.window = 1;
  weights.lstm[0].bias_ih << 9, 9, 9, 9, 9, 9, 9, 9, 0.1F, 0.1F, 0.1F, 0.1F, 9, 9, 9, 9;  // i, f, g, o
  weights.fc_weight.setIdentity();
  weights.in_proj_weight.bottomRows(4).setIdentity();
  weights.out_proj_weight.setIdentity();
  weights.output_weight.setIdentity();
  return networkOf(weights, output);
}

TickSettings compensating() {
  TickSettings settings = holdingSettings();
  settings.compensation = CompensationSource::kNetwork;
  settings.gains.compensation = 1.0;
  return settings;
}

}  // namespace

TEST_CASE("a network's acceleration is delivered as it is, and its torque through the inertia") {
  SimulatedLeg acceleration(holdingSettings(), {},
                            constantNetwork(pair(1.5, -0.5), network::OutputKind::kAcceleration));
  const TickOutput& first = acceleration.run(50);
  CHECK(first.has_network);
  CHECK(first.f_network.isApprox(pair(1.5, -0.5), 1e-6));

  SimulatedLeg torque(holdingSettings(), {}, constantNetwork(pair(1.5, -0.5), network::OutputKind::kTorque));
  const TickOutput& second = torque.run(50);
  const model::EffectInput state{torque.plant.state().q, torque.plant.state().dq, pair(0.0, 0.0), {}, 0.0};
  const JointMatrix inertia = paperModel().evaluate(state).inertia;
  CHECK((inertia * second.f_network).isApprox(pair(1.5, -0.5), 1e-6));
}

TEST_CASE("a correcting network adds to the sampler's estimate") {
  const sim::InteractionOptions patient{.kind = sim::InteractionKind::kExperiment2};
  SimulatedLeg leg(holdingSettings(), patient,
                   constantNetwork(pair(0.2, 0.1), network::OutputKind::kAccelerationCorrection));
  const TickOutput& output = leg.run(300);
  REQUIRE(output.f_s_filtered.norm() > 0.5);
  CHECK((output.f_network - output.f_s_filtered).isApprox(pair(0.2, 0.1), 1e-6));
}

TEST_CASE("compensation by the network asks for the opposite of the torque that the network sees") {
  SimulatedLeg leg(compensating(), {}, constantNetwork(pair(1.0, 2.0), network::OutputKind::kTorque));
  leg.activate();
  const TickOutput& output = leg.run(20);
  REQUIRE(output.command.enable);
  CHECK(output.control.compensation.isApprox(pair(-1.0, -2.0), 1e-6));
}

TEST_CASE(
    "a network that contradicts the observer gives way to it, says so, and is trusted anew after a stop") {
  SimulatedLeg leg(compensating(), {}, constantNetwork(pair(0.0, 8.0), network::OutputKind::kTorque));
  leg.enable(false);
  leg.run(15);
  leg.enable(true);
  leg.run(10);
  leg.enable(false);
  leg.step();
  leg.enable(true);
  const TickOutput& first = leg.step();
  REQUIRE(first.state == State::kActive);
  CHECK_FALSE(leg.step().warnings.any());
  const TickOutput& trusted = leg.run(15);
  CHECK_FALSE(trusted.warnings.any());
  CHECK(trusted.control.compensation[1] == doctest::Approx(-8.0));
  const TickOutput& distrusted = leg.run(20);
  CHECK(distrusted.warnings.has(safety::Warning::kNetworkFallback));
  CHECK(std::abs(distrusted.control.compensation[1]) < 0.5);
  CHECK(distrusted.state == State::kActive);
}

TEST_CASE("no estimate of a network without a new encoder sample") {
  SimulatedLeg leg(holdingSettings(), {}, constantNetwork(pair(1.0, 2.0), network::OutputKind::kTorque));
  leg.run(50);
  CHECK_FALSE(leg.step(0).has_network);
  CHECK(leg.step(2).has_network);
}

TEST_CASE("a network that does not fit is refused by what does not fit") {
  const JointVector one = JointVector::Constant(1, 1.0);
  CHECK_THROWS_WITH_AS(
      SimulatedLeg(holdingSettings(), {}, constantNetwork(one, network::OutputKind::kTorque)),
      "the network has 1 outputs, expected 2, one for each joint of the model", std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      SimulatedLeg(holdingSettings(), {},
                   constantNetwork(pair(1.0, 1.0), network::OutputKind::kTorque, {"q1_rad", "knee_angle"})),
      doctest::Contains("feature 'knee_angle' of the network is unknown"), std::invalid_argument);
  CHECK_THROWS_WITH_AS((void)SimulatedLeg(compensating()), "compensation by the network needs a network",
                       std::invalid_argument);
}

TEST_CASE("a network of a lower rate takes every few samples, and corrects every estimate between them") {
  TickSettings settings = holdingSettings();
  settings.network_stride = 4;
  const sim::InteractionOptions patient{.kind = sim::InteractionKind::kExperiment2};
  SimulatedLeg slow(settings, patient, countingNetwork(network::OutputKind::kAccelerationCorrection));
  JointVector before = pair(-1.0, -1.0);
  std::vector<int> changed;
  for (int tick = 0; tick < 13; ++tick) {
    const TickOutput& output = slow.step();
    REQUIRE(output.has_network);
    const JointVector value = output.f_network - output.f_s_filtered;
    if ((value - before).norm() > 1e-6) {
      changed.push_back(tick);
    }
    before = value;
  }
  CHECK(changed == std::vector<int>{0, 4, 8, 12});
}
