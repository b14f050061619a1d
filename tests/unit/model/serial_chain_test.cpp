// The chain against the special cases, and the identities that every mechanism must satisfy.
#include <cmath>
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

constexpr double kEqual = 1e-12;  // of the largest number of the term

const PlanarTwoLinkParameters kUneven{.mass_kg = {2.1, 0.9},
                                      .length_m = {0.23, 0.31},
                                      .com_m = {0.09, 0.17},
                                      .inertia_kg_m2 = {0.021, 0.013},
                                      .gravity_m_s2 = 9.81};

template <typename Found, typename Expected>
double difference(const Found& found, const Expected& expected) {
  return (found - expected).cwiseAbs().maxCoeff() / std::max(1.0, expected.cwiseAbs().maxCoeff());
}

void checkEqual(const SerialChain& chain, const Mechanism& special) {
  REQUIRE(chain.joints() == special.joints());
  for (const auto& [q, dq, ddq] : test::randomStates(chain.joints())) {
    CHECK(difference(chain.inertia(q), special.inertia(q)) < kEqual);
    CHECK(difference(chain.coriolis(q, dq), special.coriolis(q, dq)) < kEqual);
    CHECK(difference(chain.gravity(q), special.gravity(q)) < kEqual);
    CHECK(difference(chain.jacobian(q).topRows(2), special.jacobian(q)) < kEqual);
    CHECK(chain.jacobian(q).bottomRows(1).cwiseAbs().maxCoeff() < kEqual);
    CHECK(chain.kineticEnergy(q, dq) == doctest::Approx(special.kineticEnergy(q, dq)).epsilon(kEqual));
    const int last = chain.joints() - 1;
    const PointMotion found = chain.pointMotion(last, 0.2, q, dq);
    const PointMotion expected = special.pointMotion(last, 0.2, q, dq);
    if (chain.hasSegment(last)) {
      CHECK(difference(found.jacobian.topRows(2), expected.jacobian) < kEqual);
      CHECK(difference(found.bias_acceleration.head(2), expected.bias_acceleration) < kEqual);
    }
    const JointVector torque = special.regressor(q, dq, ddq) * special.baseParameters();
    CHECK(difference(chain.regressor(q, dq, ddq) * chain.baseParameters(), torque) < 1e-9);
  }
}

std::vector<SerialChain> randomChains() {
  test::RandomChains random(3);
  std::vector<SerialChain> chains;
  for (int joints = 1; joints <= kMaxJoints; ++joints) {
    for (int i = 0; i < 2; ++i) {
      chains.emplace_back(random.draw(joints));
    }
  }
  return chains;
}

JointVector inverseDynamics(const SerialChain& chain, const test::State& state) {
  const ChainTerms terms = chain.terms(state.q, state.dq);
  return terms.inertia * state.ddq + terms.velocity_Nm + terms.gravity_Nm;
}

}  // namespace

TEST_CASE("a chain of the leg's two links is the leg, one of a joint that joint") {
  checkEqual(SerialChain(test::asChain(kUneven)), PlanarTwoLink(kUneven));
  checkEqual(SerialChain(test::asChain(adultLeg().parameters)), PlanarTwoLink(adultLeg().parameters));
  const RevoluteJointParameters joint{.inertia_kg_m2 = 0.5, .moment_kg_m = 0.8, .length_m = 0.4};
  checkEqual(SerialChain(test::asChain(joint)), RevoluteJoint(joint));
  const PrismaticJointParameters axis{.mass_kg = 95.0, .inclination_rad = 0.3};
  checkEqual(SerialChain(test::asChain(axis)), PrismaticJoint(axis));
}

TEST_CASE("terms, taken together, are those taken one by one") {
  for (const SerialChain& chain : randomChains()) {
    for (const auto& [q, dq, ddq] : test::randomStates(chain.joints(), 10)) {
      const ChainTerms terms = chain.terms(q, dq);
      CHECK(difference(terms.inertia, chain.inertia(q)) < kEqual);
      CHECK(difference(terms.gravity_Nm, chain.gravity(q)) < kEqual);
      CHECK(difference(terms.velocity_Nm, chain.coriolis(q, dq) * dq) < kEqual);
      const RigidBodyTerms body = chain.rigidBody(q, dq);
      CHECK(difference(body.bias_Nm, terms.velocity_Nm + terms.gravity_Nm) < kEqual);
    }
  }
}

TEST_CASE("a chain's inertia is symmetric and positive definite, and dI/dt − 2C skew-symmetric") {
  for (const SerialChain& chain : randomChains()) {
    for (const auto& [q, dq, ddq] : test::randomStates(chain.joints(), 10)) {
      const JointMatrix inertia = chain.inertia(q);
      CHECK(inertia.isApprox(inertia.transpose(), 0.0));
      CHECK(Eigen::MatrixXd(inertia).llt().info() == Eigen::Success);
      CHECK(chain.kineticEnergy(q, dq) == doctest::Approx(0.5 * dq.dot(inertia * dq)).epsilon(kEqual));
      constexpr double h = 1e-6;
      const JointMatrix rate = (chain.inertia(q + h * dq) - chain.inertia(q - h * dq)) / (2.0 * h);
      const JointMatrix rest = rate - 2.0 * chain.coriolis(q, dq);
      CHECK((rest + rest.transpose()).cwiseAbs().maxCoeff() <
            1e-7 * std::max(1.0, rate.cwiseAbs().maxCoeff()));
    }
  }
}

TEST_CASE("a chain's power is the rate of its energy, which is zero at the height of the first joint") {
  for (const SerialChain& chain : randomChains()) {
    const auto energy = [&](const JointVector& q, const JointVector& dq) {
      return chain.kineticEnergy(q, dq) + chain.potentialEnergy(q);
    };
    for (const auto& state : test::randomStates(chain.joints(), 10)) {
      constexpr double h = 1e-6;
      const double rate = (energy(state.q + h * state.dq, state.dq + h * state.ddq) -
                           energy(state.q - h * state.dq, state.dq - h * state.ddq)) /
                          (2.0 * h);
      CHECK(state.dq.dot(inverseDynamics(chain, state)) == doctest::Approx(rate).epsilon(1e-6));
    }
  }
  // A mass on the first joint's axis has no height above it, wherever the base has that joint.
  SerialChainParameters wheel =
      test::asChain(RevoluteJointParameters{.inertia_kg_m2 = 0.1, .moment_kg_m = 0.0, .length_m = 0.4});
  wheel.links[0].origin_m = {0.3, 1.0, -2.0};
  CHECK(SerialChain(wheel).potentialEnergy(JointVector::Constant(1, 0.7)) == doctest::Approx(0.0));
}

TEST_CASE("a chain's Jacobians and bias accelerations are derivatives of its points") {
  for (const SerialChain& chain : randomChains()) {
    for (const auto& [q, dq, ddq] : test::randomStates(chain.joints(), 10)) {
      constexpr double h = 1e-4;
      const Eigen::Vector3d before = chain.endPoint(q - h * dq);
      const Eigen::Vector3d here = chain.endPoint(q);
      const Eigen::Vector3d after = chain.endPoint(q + h * dq);
      const double scale = std::max(1.0, dq.squaredNorm());
      CHECK((chain.jacobian(q) * dq - (after - before) / (2.0 * h)).norm() < 1e-5 * scale * dq.norm());
      for (int i = 0; i < chain.joints(); ++i) {
        const JointVector step = 1e-6 * JointVector::Unit(chain.joints(), i);
        const Eigen::Vector3d column = (chain.endPoint(q + step) - chain.endPoint(q - step)) / 2e-6;
        CHECK((chain.jacobian(q).col(i) - column).norm() < 1e-8);
      }
      const double reach = chain.parameters().links.back().origin_m.norm();
      const PointMotion motion = chain.pointMotion(chain.joints() - 1, reach, q, dq);
      CHECK(difference(motion.jacobian, chain.jacobian(q)) < kEqual);
      CHECK((motion.bias_acceleration - (after - 2.0 * here + before) / (h * h)).norm() <
            1e-4 * scale * scale);
    }
  }
}

TEST_CASE("a payload at the end point of a chain is a link with that mass there") {
  test::RandomChains random(17);
  for (const int joints : {1, 3, 6}) {
    SerialChainParameters parameters = random.draw(joints);
    parameters.links.back().joint = ChainJoint::kFixed;
    const double reach = parameters.links.back().origin_m.norm();
    const DynamicsModel carried =
        makeModel({.mechanism = parameters, .effects = {{"payload", joints - 1, {1.3, reach}}}});
    ChainLink load;
    load.name = "load";
    load.joint = ChainJoint::kFixed;
    load.mass_kg = 1.3;
    parameters.links.push_back(load);
    const DynamicsModel built = makeModel({.mechanism = parameters, .effects = {}});
    for (const auto& [q, dq, ddq] : test::randomStates(joints, 10)) {
      const EffectInput input{.q = q, .dq = dq, .torque_Nm = JointVector::Zero(joints)};
      const ModelTerms found = carried.evaluate(input);
      const ModelTerms expected = built.evaluate(input);
      CHECK(difference(found.inertia, expected.inertia) < kEqual);
      CHECK(difference(found.bias_Nm, expected.bias_Nm) < kEqual);
      CHECK(difference(found.inverse_inertia * found.inertia, JointMatrix::Identity(joints, joints)) < 1e-9);
    }
  }
  // Two joints at one place: nobody can say in which direction the distance goes.
  SerialChainParameters crossed = test::asChain(kUneven);
  crossed.links[1].origin_m.setZero();
  CHECK_THROWS_WITH_AS(makeModel({.mechanism = crossed, .effects = {{"payload", 0, {1.0, 0.2}}}}),
                       doctest::Contains("the segment of joint 1 has no length"), std::invalid_argument);
  CHECK_NOTHROW(makeModel({.mechanism = crossed, .effects = {{"payload", 0, {1.0, 0.0}}}}));
}

TEST_CASE("without torque and friction a chain conserves energy") {
  test::RandomChains random(29);
  const SerialChain chain(random.draw(4));
  struct State {
    JointVector q, dq;
  };
  const auto acceleration = [&](const State& s) -> JointVector {
    const ChainTerms terms = chain.terms(s.q, s.dq);
    return Eigen::MatrixXd(terms.inertia)
        .ldlt()
        .solve(Eigen::VectorXd(-(terms.velocity_Nm + terms.gravity_Nm)));
  };
  const auto energy = [&](const State& s) {
    return chain.kineticEnergy(s.q, s.dq) + chain.potentialEnergy(s.q);
  };
  State state{JointVector::Constant(4, 0.3), JointVector::Constant(4, -0.5)};
  const double start = energy(state);
  double swing = 0.0;
  constexpr double h = 1e-4;
  for (int n = 0; n < 5000; ++n) {
    const JointVector k1 = acceleration(state);
    const State s2{state.q + 0.5 * h * state.dq, state.dq + 0.5 * h * k1};
    const JointVector k2 = acceleration(s2);
    const State s3{state.q + 0.5 * h * s2.dq, state.dq + 0.5 * h * k2};
    const JointVector k3 = acceleration(s3);
    const State s4{state.q + h * s3.dq, state.dq + h * k3};
    const JointVector k4 = acceleration(s4);
    state.q += h / 6.0 * (state.dq + 2.0 * (s2.dq + s3.dq) + s4.dq);
    state.dq += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    swing = std::max(swing, chain.kineticEnergy(state.q, state.dq));
  }
  CHECK(swing > 4.0);  // J: it did move
  CHECK(std::abs(energy(state) - start) < 1e-8 * swing);
}

TEST_CASE("a chain's regressor times its base parameters is the inverse dynamics") {
  for (const SerialChain& chain : randomChains()) {
    REQUIRE(chain.baseParameters().size() == chain.baseParameterCount());
    REQUIRE(chain.baseParameterNames().size() == static_cast<std::size_t>(chain.baseParameterCount()));
    for (const auto& state : test::randomStates(chain.joints(), 10)) {
      const JointVector predicted = chain.regressor(state.q, state.dq, state.ddq) * chain.baseParameters();
      CHECK(difference(predicted, inverseDynamics(chain, state)) < 1e-9);
    }
  }
}

// With the centre of mass anywhere in the link, a link that turns about z in a vertical plane shows ZZ, MX
// and MY, and the second link's mass goes with the first. The leg's own five treat m2 l1 lc2 as a number of
// its own, as the thigh's length is not told, and have no MY.
TEST_CASE("base parameters are known in number and kind for the leg, and name what they are made of") {
  const SerialChain leg(test::asChain(kUneven));
  const std::vector<std::string> expected{"ZZ1 + 0.0529 M2", "MX1 + 0.23 M2", "MY1", "ZZ2", "MX2", "MY2"};
  CHECK(leg.baseParameterNames() == expected);
  const BaseParameters values = leg.baseParameters();
  const BaseParameters of_leg = PlanarTwoLink(kUneven).baseParameters();
  CHECK(values[0] == doctest::Approx(of_leg[0]).epsilon(1e-9));
  CHECK(values[1] == doctest::Approx(of_leg[3]).epsilon(1e-9));
  CHECK(values[3] == doctest::Approx(of_leg[1]).epsilon(1e-9));
  CHECK(values[4] == doctest::Approx(of_leg[4]).epsilon(1e-9));
  CHECK(std::abs(values[2]) + std::abs(values[5]) < 1e-12);
  CHECK(kUneven.length_m[0] * values[4] == doctest::Approx(of_leg[2]).epsilon(1e-9));

  SerialChainParameters flat = test::asChain(kUneven);
  flat.gravity_m_s2.setZero();
  CHECK(SerialChain(flat).baseParameterNames() ==
        std::vector<std::string>{"ZZ1 + 0.0529 M2", "ZZ2", "MX2", "MY2"});
  CHECK(SerialChain(test::asChain(PrismaticJointParameters{.mass_kg = 3.0})).baseParameterNames() ==
        std::vector<std::string>{"M1"});
}

// Seven a joint less what the first cannot show: Khalil and Dombre, Section 9.4.
TEST_CASE("an arm in general position has seven base parameters a joint, less what the first cannot show") {
  test::RandomChains random(5);
  SerialChainParameters arm = random.draw(6);
  for (ChainLink& link : arm.links) {
    link.joint = link.joint == ChainJoint::kFixed ? link.joint : ChainJoint::kRevolute;
  }
  CHECK(SerialChain(arm).baseParameterCount() == 7 * 6 - 4);
}

TEST_CASE("no call of a chain allocates") {
  test::RandomChains random(11);
  const SerialChain chain(random.draw(kMaxJoints));
  const auto state = test::randomStates(kMaxJoints, 1)[0];
  const DynamicsModel dynamics =
      makeModel(describeModel(DynamicsModel(std::make_unique<SerialChain>(chain), {})));
  const EffectInput input{.q = state.q, .dq = state.dq, .torque_Nm = JointVector::Zero(kMaxJoints)};
  const Mechanism& mechanism = chain;
  double sum = 0.0;
  const std::uint64_t before = test::allocationCount();
  sum += chain.terms(state.q, state.dq).inertia.sum();
  sum += mechanism.inertia(state.q).sum() + mechanism.coriolis(state.q, state.dq).sum();
  sum += mechanism.gravity(state.q).sum() + mechanism.jacobian(state.q).sum();
  sum += mechanism.rigidBody(state.q, state.dq).bias_Nm.sum();
  sum += mechanism.pointMotion(7, 0.1, state.q, state.dq).bias_acceleration.sum();
  sum += mechanism.kineticEnergy(state.q, state.dq) + mechanism.potentialEnergy(state.q);
  sum += (mechanism.regressor(state.q, state.dq, state.ddq) * mechanism.baseParameters()).sum();
  sum += dynamics.evaluate(input).f.sum();
  CHECK(test::allocationCount() - before == 0);
  CHECK(std::isfinite(sum));
}
