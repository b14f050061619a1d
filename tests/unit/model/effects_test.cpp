#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/model/dynamics_model.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/planar_two_link.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

const PlanarTwoLinkParameters kLeg{.mass_kg = {7.3, 4.1},
                                   .length_m = {0.42, 0.39},
                                   .com_m = {0.18, 0.24},
                                   .inertia_kg_m2 = {0.13, 0.11},
                                   .gravity_m_s2 = 9.81};

EffectInput inputOf(const test::State& state) {
  return {.q = state.q, .dq = state.dq, .torque_Nm = JointVector::Zero(state.q.size())};
}

/// The link with a point mass fixed to it: masses add, the centre moves, Steiner's terms join the inertia.
PlanarTwoLinkParameters loaded(PlanarTwoLinkParameters leg, std::size_t link, double mass, double distance) {
  const double total = leg.mass_kg[link] + mass;
  const double com = (leg.mass_kg[link] * leg.com_m[link] + mass * distance) / total;
  leg.inertia_kg_m2[link] +=
      leg.mass_kg[link] * std::pow(leg.com_m[link] - com, 2) + mass * std::pow(distance - com, 2);
  leg.mass_kg[link] = total;
  leg.com_m[link] = com;
  return leg;
}

template <typename... Values>
JointVector torqueOf(std::string_view kind, int joint, const Mechanism& mechanism, const EffectInput& input,
                     Values... values) {
  return makeEffect(kind, joint, mechanism, std::array{values...})->torque(input);
}

}  // namespace

TEST_CASE("friction and stiffness act on their joint alone, as their equations say") {
  const PlanarTwoLink leg(kLeg);
  for (const auto& state : test::randomStates(2)) {
    const EffectInput input = inputOf(state);
    for (int joint = 0; joint < 2; ++joint) {
      const JointVector unit = JointVector::Unit(2, joint);
      const double q = state.q[joint];
      const double dq = state.dq[joint];
      CHECK(torqueOf("viscous_friction", joint, leg, input, 0.7).isApprox(-0.7 * dq * unit, 1e-14));
      CHECK(torqueOf("coulomb_friction", joint, leg, input, 1.3, 0.5)
                .isApprox(-1.3 * std::tanh(dq / 0.5) * unit, 1e-14));
      CHECK(torqueOf("linear_stiffness", joint, leg, input, 4.0, -0.4)
                .isApprox(-4.0 * (q + 0.4) * unit, 1e-14));
    }
  }
}

TEST_CASE("friction never drives the leg") {
  const PlanarTwoLink leg(kLeg);
  for (const auto& state : test::randomStates(2)) {
    for (int joint = 0; joint < 2; ++joint) {
      CHECK(state.dq.dot(torqueOf("viscous_friction", joint, leg, inputOf(state), 0.7)) < 0.0);
      CHECK(state.dq.dot(torqueOf("coulomb_friction", joint, leg, inputOf(state), 0.7, 0.01)) < 0.0);
    }
  }
}

TEST_CASE("Coulomb friction is at its level away from rest and continuous through it") {
  const RevoluteJoint knee({.inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4});
  EffectInput input{.q = JointVector::Zero(1), .dq = JointVector::Zero(1), .torque_Nm = JointVector::Zero(1)};
  CHECK(torqueOf("coulomb_friction", 0, knee, input, 2.0, 0.01)[0] == 0.0);
  input.dq[0] = -0.1;
  CHECK(torqueOf("coulomb_friction", 0, knee, input, 2.0, 0.01)[0] == doctest::Approx(2.0).epsilon(1e-6));
  input.dq[0] = 1e-6;
  CHECK(torqueOf("coulomb_friction", 0, knee, input, 2.0, 0.01)[0] == doctest::Approx(-2e-4).epsilon(1e-6));
}

TEST_CASE("a payload makes the leg the one with heavier links") {
  for (std::size_t link = 0; link < 2; ++link) {
    auto bare = std::make_unique<PlanarTwoLink>(kLeg);
    std::vector<std::unique_ptr<Effect>> effects;
    effects.push_back(makeEffect("payload", static_cast<int>(link), *bare, std::array{2.4, 0.31}));
    const DynamicsModel carrying(std::move(bare), std::move(effects));
    const DynamicsModel heavier(std::make_unique<PlanarTwoLink>(loaded(kLeg, link, 2.4, 0.31)), {});
    for (const auto& state : test::randomStates(2)) {
      const ModelTerms actual = carrying.evaluate(inputOf(state));
      const ModelTerms expected = heavier.evaluate(inputOf(state));
      CHECK(actual.inertia.isApprox(expected.inertia, 1e-12));
      CHECK((actual.bias_Nm - expected.bias_Nm).norm() < 1e-11);
      CHECK(actual.f.isApprox(expected.f, 1e-10));
    }
  }
}

TEST_CASE("a payload on one joint adds its inertia and weight") {
  const RevoluteJoint knee({.inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4});
  const PrismaticJoint axis({.mass_kg = 95.0, .inclination_rad = 0.3});
  for (const auto& state : test::randomStates(1)) {
    const auto on_knee = makeEffect("payload", 0, knee, std::array{2.0, 0.3});
    CHECK(on_knee->inertia(state.q)(0, 0) == doctest::Approx(2.0 * 0.3 * 0.3));
    CHECK(on_knee->torque(inputOf(state))[0] == doctest::Approx(-2.0 * 9.81 * 0.3 * std::cos(state.q[0])));
    const auto on_axis = makeEffect("payload", 0, axis, std::array{2.0, 0.3});
    CHECK(on_axis->inertia(state.q)(0, 0) == doctest::Approx(2.0));
    CHECK(on_axis->torque(inputOf(state))[0] == doctest::Approx(-2.0 * 9.81 * std::sin(0.3)));
  }
}

TEST_CASE("rotor inertia is added to its own diagonal element and exerts no torque at zero acceleration") {
  const PlanarTwoLink leg(kLeg);
  for (int joint = 0; joint < 2; ++joint) {
    const auto rotor = makeEffect("rotor_inertia", joint, leg, std::array{0.05});
    for (const auto& state : test::randomStates(2)) {
      const JointVector unit = JointVector::Unit(2, joint);
      CHECK(rotor->inertia(state.q).isApprox(0.05 * unit * unit.transpose(), 1e-15));
      CHECK(rotor->torque(inputOf(state)).isZero(0.0));
    }
  }
}

TEST_CASE("every kind of the catalogue can be made as described, on every mechanism") {
  const PlanarTwoLink leg(kLeg);
  const PrismaticJoint axis({.mass_kg = 95.0});
  std::set<std::string_view> kinds;
  for (const EffectDescriptor* descriptor : effectCatalogue()) {
    CAPTURE(descriptor->kind);
    CHECK(kinds.insert(descriptor->kind).second);
    CHECK(findEffect(descriptor->kind) == descriptor);
    CHECK_FALSE(descriptor->equation.empty());
    CHECK_FALSE(descriptor->source.empty());
    std::vector<double> initial;
    for (const EffectParameter& parameter : descriptor->parameters) {
      CAPTURE(parameter.name);
      CHECK(parameter.minimum < parameter.maximum);
      initial.push_back(parameter.initial);
    }
    for (const Mechanism* mechanism :
         {static_cast<const Mechanism*>(&leg), static_cast<const Mechanism*>(&axis)}) {
      const int joint = mechanism->joints() - 1;
      const auto effect = makeEffect(descriptor->kind, joint, *mechanism, initial);
      CHECK(&effect->descriptor() == descriptor);
      CHECK(effect->joint() == joint);
      CHECK(std::equal(initial.begin(), initial.end(), effect->parameters().begin(),
                       effect->parameters().end()));
      const auto state = test::randomStates(mechanism->joints(), 1).front();
      CHECK(effect->torque(inputOf(state)).size() == mechanism->joints());
      CHECK(effect->torque(inputOf(state)).allFinite());
      CHECK(effect->inertia(state.q).rows() == mechanism->joints());
    }
  }
  for (const char* kind :
       {"viscous_friction", "coulomb_friction", "linear_stiffness", "payload", "rotor_inertia"}) {
    CHECK(kinds.count(kind) == 1);
  }
  CHECK(findEffect("phlogiston") == nullptr);
}

TEST_CASE("an effect that cannot be is refused with kind, parameter, value and expectation") {
  const PlanarTwoLink leg(kLeg);
  const auto refuses = [&leg](const char* kind, int joint, const std::vector<double>& values,
                              const char* expected) {
    CHECK_THROWS_WITH_AS(makeEffect(kind, joint, leg, values), doctest::Contains(expected),
                         std::invalid_argument);
  };
  refuses("phlogiston", 0, {1.0}, "effect kind 'phlogiston' is unknown, expected one of viscous_friction, ");
  refuses("viscous_friction", 2, {1.0}, "effect viscous_friction: joint is 2, expected 0 to 1");
  refuses("viscous_friction", -1, {1.0}, "joint is -1");
  refuses("payload", 1, {1.0}, "effect payload: 1 parameters given, expected 2");
  refuses("viscous_friction", 0, {-0.1},
          "effect viscous_friction: coefficient_Nms_rad is -0.1, expected 0 to 1000");
  refuses("payload", 1, {1.0, 3.0}, "distance_m is 3");
  refuses("rotor_inertia", 1, {std::numeric_limits<double>::quiet_NaN()}, "inertia_kg_m2 is nan");
}
