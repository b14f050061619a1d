#include "core/model/dynamics_model.hpp"

#include <array>
#include <memory>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "core/model/one_dof.hpp"
#include "core/model/presets.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

DynamicsModel burdened(std::unique_ptr<Mechanism> mechanism) {
  std::vector<std::unique_ptr<Effect>> effects;
  for (int joint = 0; joint < mechanism->joints(); ++joint) {
    effects.push_back(makeEffect("viscous_friction", joint, *mechanism, std::array{0.3}));
    effects.push_back(makeEffect("coulomb_friction", joint, *mechanism, std::array{0.2, 0.05}));
    effects.push_back(makeEffect("payload", joint, *mechanism, std::array{1.1, 0.2}));
    effects.push_back(makeEffect("rotor_inertia", joint, *mechanism, std::array{0.04}));
  }
  return {std::move(mechanism), std::move(effects)};
}

void checkTerms(const DynamicsModel& model) {
  for (const auto& [q, dq, ddq] : test::randomStates(model.joints())) {
    const EffectInput input{.q = q, .dq = dq, .torque_Nm = JointVector::Zero(model.joints())};
    const ModelTerms terms = model.evaluate(input);
    JointMatrix inertia = model.mechanism().inertia(q);
    JointVector bias = model.mechanism().coriolis(q, dq) * dq + model.mechanism().gravity(q);
    for (const auto& effect : model.effects()) {
      inertia += effect->inertia(q);
      bias -= effect->torque(input);
    }
    CHECK(terms.inertia.isApprox(inertia, 1e-13));
    CHECK(terms.bias_Nm.isApprox(bias, 1e-12));
    CHECK(terms.inverse_inertia.isApprox(Eigen::MatrixXd(inertia).inverse(), 1e-12));
    // Forward dynamics undoes inverse dynamics.
    const JointVector torque = model.inverseDynamics(input, ddq);
    CHECK((terms.f + terms.inverse_inertia * torque).isApprox(ddq, 1e-10));
  }
}

}  // namespace

TEST_CASE("the terms are the sums of mechanism and effects, and solve for acceleration") {
  checkTerms(burdened(std::make_unique<PlanarTwoLink>(adultLeg().parameters)));
  checkTerms(burdened(std::make_unique<RevoluteJoint>(
      RevoluteJointParameters{.inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4})));
  checkTerms(burdened(std::make_unique<PrismaticJoint>(PrismaticJointParameters{.mass_kg = 95.0})));
}

TEST_CASE("a model keeps its effects' mechanism when it is moved") {
  DynamicsModel first = burdened(std::make_unique<PlanarTwoLink>(adultLeg().parameters));
  const auto state = test::randomStates(2, 1).front();
  const EffectInput input{.q = state.q, .dq = state.dq, .torque_Nm = JointVector::Zero(2)};
  const JointVector before = first.evaluate(input).f;
  const DynamicsModel second = std::move(first);
  CHECK(second.evaluate(input).f == before);
}

TEST_CASE("a model without its parts is refused") {
  CHECK_THROWS_AS(DynamicsModel(nullptr, {}), std::invalid_argument);
  std::vector<std::unique_ptr<Effect>> effects(1);
  CHECK_THROWS_AS(DynamicsModel(std::make_unique<PlanarTwoLink>(paperLeg().parameters), std::move(effects)),
                  std::invalid_argument);
}
