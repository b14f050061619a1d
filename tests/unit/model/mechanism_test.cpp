// Identities that every mechanism must satisfy, checked by finite differences.
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include "core/model/one_dof.hpp"
#include "core/model/presets.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

/// Unequal in every respect, so that no two parameters can be exchanged unnoticed.
const PlanarTwoLinkParameters kUneven{.mass_kg = {2.1, 0.9},
                                      .length_m = {0.23, 0.31},
                                      .com_m = {0.09, 0.17},
                                      .inertia_kg_m2 = {0.021, 0.013},
                                      .gravity_m_s2 = 9.81};

std::vector<std::unique_ptr<Mechanism>> mechanisms() {
  std::vector<std::unique_ptr<Mechanism>> all;
  all.push_back(std::make_unique<PlanarTwoLink>(kUneven));
  all.push_back(std::make_unique<PlanarTwoLink>(adultLeg().parameters));
  all.push_back(std::make_unique<RevoluteJoint>(
      RevoluteJointParameters{.inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4}));
  all.push_back(
      std::make_unique<PrismaticJoint>(PrismaticJointParameters{.mass_kg = 95.0, .inclination_rad = 0.3}));
  return all;
}

JointVector inverseDynamics(const Mechanism& mechanism, const test::State& state) {
  return mechanism.inertia(state.q) * state.ddq + mechanism.coriolis(state.q, state.dq) * state.dq +
         mechanism.gravity(state.q);
}

/// Where the end point is, from the geometry alone.
Eigen::Vector2d endPoint(const Mechanism& mechanism, const JointVector& q) {
  const auto direction = [](double angle) { return Eigen::Vector2d(std::cos(angle), std::sin(angle)); };
  if (const auto* leg = dynamic_cast<const PlanarTwoLink*>(&mechanism)) {
    return leg->parameters().length_m[0] * direction(q[0]) +
           leg->parameters().length_m[1] * direction(q[0] + q[1]);
  }
  if (const auto* knee = dynamic_cast<const RevoluteJoint*>(&mechanism)) {
    return knee->parameters().length_m * direction(q[0]);
  }
  const auto& axis = dynamic_cast<const PrismaticJoint&>(mechanism);
  return q[0] * direction(axis.parameters().inclination_rad);
}

}  // namespace

TEST_CASE("inertia is symmetric and positive definite") {
  for (const auto& mechanism : mechanisms()) {
    for (const auto& [q, dq, ddq] : test::randomStates(mechanism->joints())) {
      const JointMatrix inertia = mechanism->inertia(q);
      REQUIRE(inertia.rows() == mechanism->joints());
      CHECK(inertia.isApprox(inertia.transpose(), 0.0));
      CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(inertia).eigenvalues().minCoeff() > 1e-4);
      CHECK(mechanism->kineticEnergy(q, dq) == doctest::Approx(0.5 * dq.dot(inertia * dq)).epsilon(1e-12));
    }
  }
}

TEST_CASE("dI/dt − 2C is skew-symmetric") {
  for (const auto& mechanism : mechanisms()) {
    for (const auto& [q, dq, ddq] : test::randomStates(mechanism->joints())) {
      constexpr double h = 1e-6;
      const JointMatrix rate = (mechanism->inertia(q + h * dq) - mechanism->inertia(q - h * dq)) / (2.0 * h);
      const JointMatrix difference = rate - 2.0 * mechanism->coriolis(q, dq);
      CHECK((difference + difference.transpose()).cwiseAbs().maxCoeff() < 1e-7);
    }
  }
}

TEST_CASE("gravity is the gradient of potential energy, which is zero at the height of the first joint") {
  for (const auto& mechanism : mechanisms()) {
    CHECK(mechanism->potentialEnergy(JointVector::Zero(mechanism->joints())) == doctest::Approx(0.0));
    for (const auto& [q, dq, ddq] : test::randomStates(mechanism->joints())) {
      for (int i = 0; i < mechanism->joints(); ++i) {
        constexpr double h = 1e-5;
        const JointVector step = h * JointVector::Unit(mechanism->joints(), i);
        const double slope =
            (mechanism->potentialEnergy(q + step) - mechanism->potentialEnergy(q - step)) / (2.0 * h);
        CHECK(std::abs(slope - mechanism->gravity(q)[i]) < 1e-6);
      }
    }
  }
}

TEST_CASE("the power of the torque is the rate of energy") {
  for (const auto& mechanism : mechanisms()) {
    const auto energy = [&](const JointVector& q, const JointVector& dq) {
      return mechanism->kineticEnergy(q, dq) + mechanism->potentialEnergy(q);
    };
    for (const auto& state : test::randomStates(mechanism->joints())) {
      constexpr double h = 1e-6;
      const double rate = (energy(state.q + h * state.dq, state.dq + h * state.ddq) -
                           energy(state.q - h * state.dq, state.dq - h * state.ddq)) /
                          (2.0 * h);
      const double power = state.dq.dot(inverseDynamics(*mechanism, state));
      CHECK(power == doctest::Approx(rate).epsilon(1e-6));
    }
  }
}

TEST_CASE("the Jacobian and its bias acceleration are derivatives of the end point") {
  for (const auto& mechanism : mechanisms()) {
    for (const auto& [q, dq, ddq] : test::randomStates(mechanism->joints())) {
      constexpr double h = 1e-4;
      const Eigen::Vector2d before = endPoint(*mechanism, q - h * dq);
      const Eigen::Vector2d here = endPoint(*mechanism, q);
      const Eigen::Vector2d after = endPoint(*mechanism, q + h * dq);
      CHECK((mechanism->jacobian(q) * dq - (after - before) / (2.0 * h)).norm() < 1e-4);
      for (int i = 0; i < mechanism->joints(); ++i) {
        const JointVector step = 1e-6 * JointVector::Unit(mechanism->joints(), i);
        const Eigen::Vector2d column =
            (endPoint(*mechanism, q + step) - endPoint(*mechanism, q - step)) / 2e-6;
        CHECK((mechanism->jacobian(q).col(i) - column).norm() < 1e-8);
      }
      const int last = mechanism->joints() - 1;
      double reach = 0.0;
      if (const auto* leg = dynamic_cast<const PlanarTwoLink*>(mechanism.get())) {
        reach = leg->parameters().length_m[1];
      } else if (const auto* knee = dynamic_cast<const RevoluteJoint*>(mechanism.get())) {
        reach = knee->parameters().length_m;
      }
      const PointMotion motion = mechanism->pointMotion(last, reach, q, dq);
      CHECK(motion.jacobian.isApprox(mechanism->jacobian(q), 1e-14));
      CHECK((motion.bias_acceleration - (after - 2.0 * here + before) / (h * h)).norm() < 1e-3);
    }
  }
}

TEST_CASE("regressor times base parameters is the inverse dynamics") {
  for (const auto& mechanism : mechanisms()) {
    REQUIRE(mechanism->baseParameters().size() == mechanism->baseParameterCount());
    for (const auto& state : test::randomStates(mechanism->joints())) {
      const JointVector predicted =
          mechanism->regressor(state.q, state.dq, state.ddq) * mechanism->baseParameters();
      CHECK(predicted.isApprox(inverseDynamics(*mechanism, state), 1e-12));
    }
  }
}

TEST_CASE("without torque and friction energy is conserved") {
  const PlanarTwoLink leg(kUneven);
  using State = Eigen::Vector4d;
  const auto derivative = [&](const State& s) {
    const JointVector q = s.head<2>();
    const JointVector dq = s.tail<2>();
    State rate;
    rate << dq, Eigen::Matrix2d(leg.inertia(q)).ldlt().solve(-(leg.coriolis(q, dq) * dq + leg.gravity(q)));
    return rate;
  };
  const auto energy = [&](const State& s) {
    return leg.kineticEnergy(s.head<2>(), s.tail<2>()) + leg.potentialEnergy(s.head<2>());
  };
  // From the horizontal with the knee bent: the motion is chaotic and visits all of the equations.
  State state(0.0, 0.7, 1.0, -2.0);
  const double start = energy(state);
  double swing = 0.0;
  constexpr double h = 1e-4;
  for (int n = 0; n < 50000; ++n) {
    const State k1 = derivative(state);
    const State k2 = derivative(state + h / 2.0 * k1);
    const State k3 = derivative(state + h / 2.0 * k2);
    const State k4 = derivative(state + h * k3);
    state += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    swing = std::max(swing, leg.kineticEnergy(state.head<2>(), state.tail<2>()));
  }
  CHECK(swing > 4.0);  // J: it did move
  CHECK(std::abs(energy(state) - start) < 1e-8 * swing);
}

TEST_CASE("hanging is an equilibrium and lifting the leg takes torque upwards") {
  const PlanarTwoLink leg(kUneven);
  CHECK(leg.gravity(Eigen::Vector2d(-std::numbers::pi / 2.0, 0.0)).norm() < 1e-14);
  const JointVector horizontal = leg.gravity(Eigen::Vector2d(0.0, 0.0));
  CHECK(horizontal[1] == doctest::Approx(9.81 * 0.9 * 0.17));
  CHECK(horizontal[0] == doctest::Approx(9.81 * (2.1 * 0.09 + 0.9 * (0.23 + 0.17))));
}

TEST_CASE("parameters that no body can have are refused by name and value") {
  const auto refuses = [](auto change, const std::string& expected) {
    PlanarTwoLinkParameters parameters = kUneven;
    change(parameters);
    CHECK_THROWS_WITH_AS(PlanarTwoLink{parameters}, doctest::Contains(expected.c_str()),
                         std::invalid_argument);
  };
  refuses([](auto& p) { p.mass_kg[0] = 0.0; }, "mass_kg (planar_two_link)[1] = 0, expected 0.001 to 50");
  refuses([](auto& p) { p.mass_kg[1] = -1.5; }, "mass_kg (planar_two_link)[2] = -1.5");
  refuses([](auto& p) { p.length_m[1] = std::numeric_limits<double>::infinity(); },
          "length_m (planar_two_link)[2] = inf");
  refuses([](auto& p) { p.com_m[0] = -0.1; }, "com_m (planar_two_link)[1] = -0.1");
  refuses([](auto& p) { p.inertia_kg_m2[1] = std::nan(""); }, "inertia_kg_m2 (planar_two_link)[2] = nan");
  refuses([](auto& p) { p.com_m[1] = p.inertia_kg_m2[1] = 0.0; }, "inertia_kg_m2[2] + mass_kg[2]");
  refuses([](auto& p) { p.gravity_m_s2 = -9.81; }, "gravity_m_s2 = -9.81");
  CHECK_THROWS_AS(RevoluteJoint({.inertia_kg_m2 = 0.0, .moment_kg_m = 0.1, .length_m = 0.4}),
                  std::invalid_argument);
  CHECK_THROWS_AS(RevoluteJoint({.inertia_kg_m2 = 0.1, .moment_kg_m = -0.1, .length_m = 0.4}),
                  std::invalid_argument);
  CHECK_THROWS_AS(PrismaticJoint({.mass_kg = -1.0}), std::invalid_argument);
  refuses([](auto& p) { p.gravity_m_s2 = 981.0; }, "gravity_m_s2 = 981, expected 0 to 10");
  refuses([](auto& p) { p.mass_kg[1] = 1e300; }, "mass_kg (planar_two_link)[2] = 1e+300");
  refuses([](auto& p) { p.length_m[0] = 1e9; }, "length_m (planar_two_link)[1] = 1e+09, expected 0.01 to 2");
  CHECK_THROWS_AS(RevoluteJoint({.inertia_kg_m2 = 21.0, .moment_kg_m = 0.1, .length_m = 0.4}),
                  std::invalid_argument);
  CHECK_THROWS_AS(PrismaticJoint({.mass_kg = 1001.0}), std::invalid_argument);
  CHECK_THROWS_AS(PrismaticJoint({.mass_kg = 1.0, .inclination_rad = std::nan("")}), std::invalid_argument);
}
