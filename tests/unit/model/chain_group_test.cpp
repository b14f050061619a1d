// Several chains on one base: equal to each of them alone, and nothing between them.
#include "core/model/chain_group.hpp"

#include <string>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "core/model/effect.hpp"
#include "core/model/model_description.hpp"
#include "core/model/presets.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/model/chains.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

constexpr double kEqual = 1e-12;

ChainGroupParameters drawn(test::RandomChains& random, std::initializer_list<int> joints) {
  ChainGroupParameters group;
  for (const int count : joints) {
    group.chains.push_back(random.draw(count));
    group.chains.back().gravity_m_s2 = group.chains.front().gravity_m_s2;
  }
  return group;
}

EffectInput inputAt(const test::State& state) {
  return {.q = state.q, .dq = state.dq, .torque_Nm = JointVector::Zero(state.q.size())};
}

}  // namespace

TEST_CASE("each block of a group is the chain alone, to the bit, and between the blocks is nothing") {
  test::RandomChains random(21);
  for (const auto& joints : {std::initializer_list<int>{2, 2}, {1, 3, 4}, {8}, {3, 1}}) {
    const ChainGroupParameters parameters = drawn(random, joints);
    const ChainGroup group(parameters);
    REQUIRE(group.joints() == parameters.joints());
    for (const auto& [q, dq, ddq] : test::randomStates(group.joints(), 20)) {
      JointMatrix inertia = group.inertia(q);
      JointMatrix coriolis = group.coriolis(q, dq);
      const RigidBodyTerms body = group.rigidBody(q, dq);
      CHECK((body.inertia - inertia).cwiseAbs().maxCoeff() < kEqual * inertia.maxCoeff());
      const JointVector torque = group.regressor(q, dq, ddq) * group.baseParameters();
      double kinetic_J = 0.0;
      double potential_J = 0.0;
      int first = 0;
      for (const SerialChainParameters& one : parameters.chains) {
        const SerialChain chain(one);
        const int n = chain.joints();
        const JointVector own_q = q.segment(first, n);
        const JointVector own_dq = dq.segment(first, n);
        const JointVector own_ddq = ddq.segment(first, n);
        CHECK(inertia.block(first, first, n, n) == chain.inertia(own_q));
        CHECK(coriolis.block(first, first, n, n) == chain.coriolis(own_q, own_dq));
        CHECK(group.gravity(q).segment(first, n) == chain.gravity(own_q));
        CHECK(body.bias_Nm.segment(first, n) == chain.rigidBody(own_q, own_dq).bias_Nm);
        const JointVector own_torque = chain.regressor(own_q, own_dq, own_ddq) * chain.baseParameters();
        CHECK((torque.segment(first, n) - own_torque).norm() < kEqual * own_torque.norm());
        for (int joint = 0; joint < n; ++joint) {
          const PointMotion found = group.pointMotion(first + joint, 0.1, q, dq);
          const PointMotion expected = chain.pointMotion(joint, 0.1, own_q, own_dq);
          CHECK(found.bias_acceleration == expected.bias_acceleration);
          CHECK(found.jacobian.middleCols(first, n) == expected.jacobian);
          CHECK(found.jacobian.squaredNorm() == doctest::Approx(expected.jacobian.squaredNorm()));
          CHECK(group.jointBefore(first + joint) == (joint == 0 ? -1 : first + joint - 1));
          CHECK(group.hasSegment(first + joint) == chain.hasSegment(joint));
        }
        kinetic_J += chain.kineticEnergy(own_q, own_dq);
        potential_J += chain.potentialEnergy(own_q);
        inertia.block(first, first, n, n).setZero();
        coriolis.block(first, first, n, n).setZero();
        first += n;
      }
      CHECK(inertia.isZero(0.0));
      CHECK(coriolis.isZero(0.0));
      CHECK(group.kineticEnergy(q, dq) == doctest::Approx(kinetic_J).epsilon(kEqual));
      CHECK(group.potentialEnergy(q) == doctest::Approx(potential_J).epsilon(kEqual));
    }
  }
}

TEST_CASE("two legs in one model are two models of a leg, effects included") {
  const SerialChainParameters leg = test::asChain(adultLeg().parameters);
  const auto effects = [](std::initializer_list<int> first_joints) {
    std::vector<EffectDescription> all;
    for (const int first : first_joints) {
      all.push_back({.kind = "payload", .joint = first + 1, .parameters = {1.5, 0.3}});
      all.push_back({.kind = "viscous_friction", .joint = first, .parameters = {0.7}});
      EffectDescription knee{.kind = "passive_knee_moment", .joint = first + 1, .parameters = {}};
      for (const EffectParameter& parameter : findEffect(knee.kind)->parameters) {
        knee.parameters.push_back(parameter.initial);
      }
      all.push_back(knee);
      // On a hip nothing carries the joint, whatever the joint before it is.
      knee.joint = first;
      all.push_back(knee);
    }
    return all;
  };
  const DynamicsModel both =
      makeModel({.mechanism = ChainGroupParameters{{leg, leg}}, .effects = effects({0, 2})});
  const DynamicsModel one = makeModel({.mechanism = leg, .effects = effects({0})});
  for (const test::State& state : test::randomStates(4, 30)) {
    const ModelTerms terms = both.evaluate(inputAt(state));
    for (const int first : {0, 2}) {
      const ModelTerms own = one.evaluate(inputAt({.q = state.q.segment(first, 2),
                                                   .dq = state.dq.segment(first, 2),
                                                   .ddq = state.ddq.segment(first, 2)}));
      CHECK((terms.f.segment(first, 2) - own.f).norm() < kEqual * (1.0 + own.f.norm()));
      CHECK((terms.inverse_inertia.block(first, first, 2, 2) - own.inverse_inertia).norm() <
            kEqual * own.inverse_inertia.norm());
      CHECK(terms.inverse_inertia.block(first, 2 - first, 2, 2).isZero(0.0));
    }
  }
}

TEST_CASE("chains of one group stand on one base and have eight joints at most") {
  test::RandomChains random(5);
  CHECK_THROWS_WITH_AS(
      ChainGroup(drawn(random, {4, 5})),
      "serial_chain: 2 chains with 9 joints that are not fixed, expected 1 to 8 joints together",
      std::invalid_argument);
  CHECK_THROWS_WITH_AS(ChainGroup({}), doctest::Contains("0 chains with 0 joints"), std::invalid_argument);
  ChainGroupParameters tilted = drawn(random, {2, 2});
  tilted.chains[1].gravity_m_s2 *= -1.0;
  CHECK_THROWS_WITH_AS(ChainGroup{tilted},
                       doctest::Contains("gravity_m_s2 of chain 2 is not that of chain 1"),
                       std::invalid_argument);
  ChainGroupParameters weightless = drawn(random, {2, 2});
  weightless.chains[1].links.clear();
  CHECK_THROWS_WITH_AS(ChainGroup{weightless}, doctest::Contains("chain 2: serial_chain: 0 joints"),
                       std::invalid_argument);
}

TEST_CASE("no call of a group allocates") {
  test::RandomChains random(12);
  const ChainGroup group(drawn(random, {4, 4}));
  const auto state = test::randomStates(kMaxJoints, 1)[0];
  const DynamicsModel dynamics =
      makeModel(describeModel(DynamicsModel(std::make_unique<ChainGroup>(group), {})));
  const EffectInput input = inputAt(state);
  double sum = 0.0;
  const std::uint64_t before = test::allocationCount();
  sum +=
      group.inertia(state.q).sum() + group.coriolis(state.q, state.dq).sum() + group.gravity(state.q).sum();
  sum += group.rigidBody(state.q, state.dq).bias_Nm.sum() + group.jacobian(state.q).sum();
  sum += group.pointMotion(7, 0.1, state.q, state.dq).bias_acceleration.sum();
  sum += group.kineticEnergy(state.q, state.dq) + group.potentialEnergy(state.q);
  sum += (group.regressor(state.q, state.dq, state.ddq) * group.baseParameters()).sum();
  sum += dynamics.evaluate(input).f.sum();
  CHECK(test::allocationCount() - before == 0);
  CHECK(std::isfinite(sum));
}
