// Particulars of the effects of the person and of how the robot is strapped on.
#include <algorithm>

#include <doctest/doctest.h>

#include "tests/unit/model/effect_fixture.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

constexpr double kPerDegree = 180.0 / std::numbers::pi;

/// Riener and Edrich 1999, Table 3: moment that flexes the knee, N·m, of the angles in degrees.
double publishedMoment_Nm(double knee_deg, double hip_deg, bool with_stop) {
  return std::exp(1.800 - 0.0352 * knee_deg + 0.0217 * hip_deg) -
         std::exp(-3.971 + 0.0495 * knee_deg - 0.0128 * hip_deg) - 4.820 +
         (with_stop ? std::exp(2.220 - 0.150 * knee_deg) : 0.0);
}

EffectInput legAt(double hip_rad, double knee_rad) {
  JointVector q(2);
  q << hip_rad, knee_rad;
  return {.q = q, .dq = JointVector::Zero(2), .torque_Nm = JointVector::Zero(2)};
}

std::vector<double> passiveValues(double stop_Nm) {
  std::vector<double> values = test::initialValues(*findEffect("passive_knee_moment"));
  values[7] = stop_Nm;
  return values;
}

EffectInput moving(double dq, double time_s, double activation = 0.0) {
  return {.q = JointVector::Zero(1),
          .dq = JointVector::Constant(1, dq),
          .torque_Nm = JointVector::Zero(1),
          .activation = {0.0, activation, 0.0, 0.0},
          .time_s = time_s};
}

}  // namespace

TEST_CASE("the passive knee moment is the published one in the loop's angles") {
  const auto leg = test::makeMechanism("leg");
  for (const double stop_Nm : {0.0, std::exp(2.220)}) {
    const auto passive = makeEffect("passive_knee_moment", 1, *leg, passiveValues(stop_Nm));
    for (const double knee_deg : {0.0, 15.0, 45.0, 90.0, 120.0}) {
      for (const double hip_deg : {0.0, 30.0, 90.0}) {
        // Upright trunk: the thigh hangs at -90° where the hip is straight.
        const EffectInput input = legAt((hip_deg - 90.0) / kPerDegree, -knee_deg / kPerDegree);
        const JointVector torque = passive->torque(input);
        CHECK(torque[0] == 0.0);
        CHECK(torque[1] == doctest::Approx(-publishedMoment_Nm(knee_deg, hip_deg, stop_Nm > 0.0)));
      }
    }
  }
}

TEST_CASE("the passive knee moment holds the knee inside its range") {
  const auto leg = test::makeMechanism("leg");
  const auto passive = makeEffect("passive_knee_moment", 1, *leg, passiveValues(0.0));
  // Seated and straight the hamstrings flex; fully bent the quadriceps extends.
  CHECK(passive->torque(legAt(0.0, 0.0))[1] < -20.0);
  CHECK(passive->torque(legAt(0.0, -2.4))[1] > 5.0);
  for (const double angle : {-1e6, -100.0, 100.0, 1e6}) {
    CHECK(std::abs(passive->torque(legAt(0.0, angle))[1]) < 2100.0);
  }
}

TEST_CASE("without a hip the passive knee moment is that of a horizontal thigh") {
  const auto knee = test::makeMechanism("knee");
  const auto passive = makeEffect("passive_knee_moment", 0, *knee, passiveValues(0.0));
  EffectInput input = moving(0.0, 0.0);
  input.q[0] = -60.0 / kPerDegree;
  CHECK(passive->torque(input)[0] == doctest::Approx(-publishedMoment_Nm(60.0, 90.0, false)));
}

TEST_CASE("with an encoder offset the model is the one at the true angle") {
  for (const char* name : test::kMechanisms) {
    const auto mechanism = test::makeMechanism(name);
    for (int joint = 0; joint < mechanism->joints(); ++joint) {
      CAPTURE(std::string(name));
      CAPTURE(joint);
      constexpr double kOffset_rad = 0.07;
      const DynamicsModel shifted = test::modelWith(name, "encoder_offset", joint, {kOffset_rad});
      const DynamicsModel bare(test::makeMechanism(name), {});
      for (const auto& [q, dq, ddq] : test::randomStates(mechanism->joints())) {
        const JointVector zero = JointVector::Zero(q.size());
        JointVector true_q = q;
        true_q[joint] += kOffset_rad;
        const JointVector expected = bare.inverseDynamics({.q = true_q, .dq = dq, .torque_Nm = zero}, ddq);
        const JointVector actual = shifted.inverseDynamics({.q = q, .dq = dq, .torque_Nm = zero}, ddq);
        CHECK((actual - expected).cwiseAbs().maxCoeff() < 1e-10);
      }
    }
  }
}

TEST_CASE("tremor keeps time with the clock") {
  const auto knee = test::makeMechanism("knee");
  const auto tremor = makeEffect("tremor", 0, *knee, std::array{0.7, 5.0, 0.4});
  for (const double time_s : {0.0, 0.033, 12.5}) {
    CHECK(tremor->torque(moving(0.0, time_s))[0] ==
          doctest::Approx(0.7 * std::sin(2.0 * std::numbers::pi * 5.0 * time_s + 0.4)));
  }
}

TEST_CASE("a spastic muscle answers a fast stretch alone, late and against it") {
  const auto knee = test::makeMechanism("knee");
  for (const double direction : {-1.0, 1.0}) {
    const auto reflex = makeEffect("spasticity", 0, *knee, std::array{3.0, 0.5, 0.04, direction});
    for (const double speed : {0.4, 2.0}) {
      for (const double sign : {-1.0, 1.0}) {
        reflex->reset(moving(0.0, 0.0));
        for (int n = 1; n <= 100; ++n) {
          const EffectInput input = moving(sign * speed, 1e-3 * n);
          reflex->advance(input, 1e-3);
          const bool answered = n >= 41 && sign == direction && speed > 0.5;
          const double expected = answered ? -direction * 3.0 * (speed - 0.5) : 0.0;
          REQUIRE(reflex->torque(input)[0] == doctest::Approx(expected));
        }
      }
    }
  }
}

TEST_CASE("EMG torque is the activation of its channel, late by the electromechanical delay") {
  const auto knee = test::makeMechanism("knee");
  const auto muscle = makeEffect("emg_torque", 0, *knee, std::array{-20.0, 2.0, 0.0635});
  const auto other = makeEffect("emg_torque", 0, *knee, std::array{-20.0, 3.0, 0.0635});
  const auto activation = [](double t) { return t < 0.0 ? 0.0 : std::min(t, 0.5); };
  muscle->reset(moving(0.0, 0.0, 0.0));
  other->reset(moving(0.0, 0.0, 0.0));
  for (int n = 1; n <= 800; ++n) {
    const double t = 1e-3 * n;
    const EffectInput input = moving(0.0, t, activation(t));
    muscle->advance(input, 1e-3);
    other->advance(input, 1e-3);
    REQUIRE(std::abs(muscle->torque(input)[0] + 20.0 * activation(t - 0.0635)) < 1e-9);
    REQUIRE(other->torque(input)[0] == 0.0);
  }
}
