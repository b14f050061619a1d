#include "sim/plant.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "core/model/model_description.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/planar_two_link.hpp"
#include "core/model/presets.hpp"
#include "sim/emg_generator.hpp"
#include "tests/support/joint_pair.hpp"
#include "tests/unit/model/chains.hpp"

using namespace patella;
using namespace patella::sim;
using patella::test::pair;

namespace {

model::DynamicsModel undamped() {
  return {std::make_unique<model::PlanarTwoLink>(model::paperLeg().parameters), {}};
}

PlantState hanging() {
  return {pair(-std::numbers::pi / 2.0, 0.0), pair(0.0, 0.0)};
}

const JointVector kNoTorque = JointVector::Zero(2);

PlantState swingFor(double duration_s, double step_s) {
  Plant plant(undamped(), undamped(), {}, 1, {pair(-0.3, 0.9), pair(1.0, -2.0)}, step_s);
  plant.advance(pair(0.4, -0.2), {}, duration_s);
  return plant.state();
}

}  // namespace

TEST_CASE("the undamped leg keeps its energy through a large swing") {
  Plant plant(undamped(), undamped(), {}, 1, {pair(0.5, 1.2), pair(0.0, 0.0)});
  const double initial_J = plant.energy();
  double kinetic_range_J = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    plant.advance(kNoTorque, {}, 1e-3);
    kinetic_range_J = std::max(kinetic_range_J, plant.state().dq.norm());
    REQUIRE(std::abs(plant.energy() - initial_J) < 1e-6);
  }
  CHECK(kinetic_range_J > 5.0);
}

TEST_CASE("the integrator is of fourth order") {
  const PlantState reference = swingFor(0.4, 1e-4);
  const double coarse = (swingFor(0.4, 0.01).q - reference.q).norm();
  const double fine = (swingFor(0.4, 0.005).q - reference.q).norm();
  CHECK(std::log2(coarse / fine) > 3.6);
  CHECK(std::log2(coarse / fine) < 4.4);
}

TEST_CASE("a hanging leg stays at rest, a lifted one falls") {
  Plant plant(undamped(), undamped(), {}, 1, hanging());
  plant.advance(kNoTorque, {}, 5.0);
  CHECK((plant.state().q - hanging().q).norm() < 1e-9);
  CHECK(plant.state().dq.norm() < 1e-9);

  Plant lifted(undamped(), undamped(), {}, 1, {pair(0.0, 0.0), pair(0.0, 0.0)});
  lifted.advance(kNoTorque, {}, 0.05);
  CHECK(lifted.state().dq(0) < -0.1);
}

TEST_CASE("nothing is unknown when the loop has the truth and nobody pushes") {
  Plant plant(model::makeModel(model::paperLeg()), model::makeModel(model::paperLeg()), {}, 1,
              {pair(-1.0, 0.4), pair(2.0, -1.0)});
  CHECK(plant.unknownDynamics().norm() < 1e-12);
  for (int i = 0; i < 500; ++i) {
    plant.advance(pair(0.5, 0.2), {}, 1e-3);
    REQUIRE(plant.takeMeanUnknownDynamics().norm() < 1e-5);
  }
}

TEST_CASE("the unknown dynamics is the interaction, in either form") {
  for (const InteractionForm form : {InteractionForm::kAsPrinted, InteractionForm::kCorrected}) {
    const InteractionOptions interaction{.kind = InteractionKind::kExperiment1, .form = form};
    Plant plant(model::makeModel(model::physicalLeg()), model::makeModel(model::physicalLeg()), interaction,
                1, {pair(-1.2, 0.5), pair(0.3, -0.2)});
    plant.advance(pair(1.0, 0.3), {}, 0.2);
    plant.takeMeanUnknownDynamics();
    const JointVector before = plant.unknownDynamics();
    plant.advance(pair(1.0, 0.3), {}, 1e-3);
    const JointVector after = plant.unknownDynamics();

    const model::PlanarTwoLink leg(model::physicalLeg().parameters);
    const Eigen::Vector2d h = InteractionForce(interaction, 1).at(plant.time_s());
    const JointVector& q = plant.state().q;
    const JointVector expected =
        form == InteractionForm::kAsPrinted
            ? JointVector(leg.jacobian(q) * h)
            : JointVector(leg.inertia(q).inverse() * leg.jacobian(q).transpose() * h);
    CHECK((after - expected).norm() < 1e-10);
    CHECK(expected.norm() > 0.3);
    // The average over the step lies in its middle.
    CHECK((plant.takeMeanUnknownDynamics() - 0.5 * (before + after)).norm() < 1e-4 * expected.norm());
  }
}

TEST_CASE("a hidden friction shows as unknown dynamics, opposed to the motion") {
  auto mechanism = std::make_unique<model::PlanarTwoLink>(model::paperLeg().parameters);
  std::vector<std::unique_ptr<model::Effect>> effects;
  effects.push_back(model::makeEffect("viscous_friction", 1, *mechanism, std::array{0.3}));
  Plant plant(model::DynamicsModel(std::move(mechanism), std::move(effects)), undamped(), {}, 1,
              {pair(-1.2, 0.5), pair(0.0, 1.5)});
  const model::PlanarTwoLink leg(model::paperLeg().parameters);
  const JointVector torque = leg.inertia(plant.state().q) * plant.unknownDynamics();
  CHECK(torque(0) == doctest::Approx(0.0));
  CHECK(torque(1) == doctest::Approx(-0.45));
}

TEST_CASE("the paper's experiments stay bounded and reach the bounds found for them") {
  struct Expected {
    InteractionKind kind;
    double first;
    double second;
  };
  for (const Expected& expected : {Expected{InteractionKind::kExperiment1, 2.51, 1.35},
                                   Expected{InteractionKind::kExperiment2, 1.35, 0.76}}) {
    Plant plant(model::makeModel(model::paperLeg()), model::makeModel(model::paperLeg()),
                {.kind = expected.kind, .form = InteractionForm::kAsPrinted}, 1, hanging(), 2e-4);
    EmgGenerator emg(paperEmg(), 1000.0, 2, 1);
    JointVector largest = JointVector::Zero(2);
    for (int k = 0; k < 50'000; ++k) {
      emg.advance(plant.time_s(), plant.state().dq);
      plant.advance(paperTorque(emg.activation()), emg.activation(), 1e-3);
      largest = largest.cwiseMax(plant.takeMeanUnknownDynamics().cwiseAbs());
      REQUIRE((plant.state().q - hanging().q).cwiseAbs().maxCoeff() < 1.0);
    }
    CHECK(largest(0) == doctest::Approx(expected.first).epsilon(0.02));
    CHECK(largest(1) == doctest::Approx(expected.second).epsilon(0.08));
  }
}

TEST_CASE("a single joint is a plant too, but has no interaction as printed") {
  const auto knee = [] {
    return model::DynamicsModel(std::make_unique<model::RevoluteJoint>(model::RevoluteJointParameters{
                                    .inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4}),
                                {});
  };
  JointVector q(1);
  q << -std::numbers::pi / 2.0;
  const PlantState rest{q, JointVector::Zero(1)};
  InteractionOptions interaction{.kind = InteractionKind::kHuman};
  Plant plant(knee(), knee(), interaction, 1, rest);
  plant.advance(JointVector::Zero(1), {}, 1.0);
  CHECK(plant.state().dq.norm() > 1e-3);

  interaction.form = InteractionForm::kAsPrinted;
  CHECK_THROWS_AS(Plant(knee(), knee(), interaction, 1, rest), std::invalid_argument);
  CHECK_THROWS_AS(Plant(knee(), knee(), {}, 1, hanging()), std::invalid_argument);
  CHECK_THROWS_AS(Plant(knee(), undamped(), {}, 1, rest), std::invalid_argument);
  CHECK_THROWS_AS(Plant(knee(), knee(), {}, 1, rest, 0.0), std::invalid_argument);
}

TEST_CASE("a chain is a plant too, but no force in the leg's plane acts on it") {
  const model::ModelDescription leg{.mechanism = test::asChain(model::adultLeg().parameters), .effects = {}};
  const model::ModelDescription planar{.mechanism = model::adultLeg().parameters, .effects = {}};
  const PlantState start{pair(-1.2, 0.5), pair(0.3, -0.2)};
  Plant chain(model::makeModel(leg), model::makeModel(leg), {}, 1, start);
  Plant same(model::makeModel(planar), model::makeModel(planar), {}, 1, start);
  for (int k = 0; k < 300; ++k) {
    chain.advance(pair(5.0, -2.0), {}, 1e-3);
    same.advance(pair(5.0, -2.0), {}, 1e-3);
  }
  CHECK((chain.state().q - same.state().q).norm() < 1e-9);
  CHECK((same.state().q - start.q).norm() > 0.05);
  CHECK_THROWS_WITH_AS(
      Plant(model::makeModel(leg), model::makeModel(leg),
            {.kind = InteractionKind::kExperiment1, .form = InteractionForm::kCorrected}, 1, start),
      doctest::Contains("the interaction force has 2 components"), std::invalid_argument);
}
