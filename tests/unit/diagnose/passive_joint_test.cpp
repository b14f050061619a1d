// Arms of which one joint has no drive: nothing there tells the scale of the masses.
#include <cmath>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "tests/unit/diagnose/swinging_arm.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/fit/passive_scale.hpp"

namespace patella::diagnose {
namespace {

model::ModelDescription damped(double second_Nms_rad = 0.004) {
  model::ModelDescription model = arm();
  model.effects = {{.kind = "viscous_friction", .joint = 0, .parameters = {0.02}},
                   {.kind = "viscous_friction", .joint = 1, .parameters = {second_Nms_rad}}};
  return model;
}

/// The shoulder is driven by three sinusoids, the elbow swings along. Positions as an encoder of 12 bits has
/// them.
Recording pushedAlong(const model::ModelDescription& truth) {
  constexpr double kRate_Hz = 250.0, kStep_rad = 2.0 * kPi / 4096.0;
  constexpr int kSteps = 40;
  model::DynamicsModel dynamics = model::makeModel(truth);
  Recording recording;
  recording.name = "along";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 2;
  recording.torque_timing = TorqueTiming::kSampled;
  model::EffectInput state;
  state.q.resize(2);
  state.q << -0.5 * kPi, 0.0;
  state.dq.setZero(2);
  state.torque_Nm.setZero(2);
  const auto torqueAt = [](double t) {
    return 0.5 * std::sin(2.0 * kPi * 0.41 * t) + 0.4 * std::sin(2.0 * kPi * 0.73 * t + 1.0) +
           0.3 * std::sin(2.0 * kPi * 1.31 * t + 2.0);
  };
  for (int i = 0; i < static_cast<int>(40.0 * kRate_Hz); ++i) {
    const double t = i / kRate_Hz;
    recording.time_s.push_back(t);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      recording.position_rad[joint].push_back(
          kStep_rad * std::round(state.q[static_cast<Eigen::Index>(joint)] / kStep_rad));
    }
    recording.torque_Nm[0].push_back(torqueAt(t));
    recording.torque_Nm[1].push_back(0.0);
    for (int k = 0; k < kSteps; ++k) {
      const double h = 1.0 / (kRate_Hz * kSteps);
      JointVector drive(2);
      drive << torqueAt(t + k * h), 0.0;
      const JointVector missing = drive - dynamics.inverseDynamics(state, JointVector::Zero(2));
      const Eigen::Matrix2d inertia = dynamics.mechanism().inertia(state.q);
      const Eigen::Vector2d ddq = inertia.ldlt().solve(Eigen::Vector2d(missing));
      state.dq += h * ddq;
      state.q += h * state.dq;
    }
  }
  recording.segments = {{.first = 0, .end = recording.rows()}};
  return recording;
}

Diagnosis diagnosed(const model::ModelDescription& truth) {
  const Recording recording = pushedAlong(truth);
  return diagnose(std::span(&recording, 1), {}, damped(), {});
}

}  // namespace

TEST_CASE(
    "an encoder's noise on a joint without a drive makes no masses smaller, and no gain of the other drive") {
  const Diagnosis diagnosis = diagnosed(damped());
  CAPTURE(diagnosis.explanation);
  CHECK(diagnosis.verdict == Verdict::kNothingMissing);
  CHECK(diagnosis.effects.empty());
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    CAPTURE(parameter.name);
    CHECK(parameter.refitted == doctest::Approx(parameter.nominal).epsilon(0.05));
  }
}

TEST_CASE("damping of a joint without a drive is found at its size") {
  const Diagnosis diagnosis = diagnosed(damped(0.012));
  REQUIRE(diagnosis.effects.size() == 1);
  CHECK(diagnosis.effects[0].kind == "viscous_friction");
  CHECK(diagnosis.effects[0].joint == 1);
  CHECK(diagnosis.effects[0].parameters[0].value == doctest::Approx(0.012).epsilon(0.1));
}

TEST_CASE("what is left without a drive counts in the load of the masses") {
  const Recording recording = swinging();
  const Dataset data(std::span(&recording, 1), {});
  const model::DynamicsModel model = model::makeModel(arm());
  const Eigen::MatrixXd regressor = data.regressor(model.mechanism(), JointVector::Zero(2));
  const Eigen::VectorXd base = model.mechanism().baseParameters();
  const PassiveScale scale(data, regressor, base, {true, false});
  const auto scaledBy = [&](const Eigen::VectorXd& other) {
    Eigen::MatrixXd column = Eigen::MatrixXd::Ones(2 * data.rows(), 1);
    scale.apply(other, column);
    return Eigen::Vector2d(column(0, 0), column(data.rows(), 0));
  };
  CHECK(scaledBy(base) == Eigen::Vector2d(1.0, 1.0));
  CHECK(scaledBy(0.5 * base)[0] == 1.0);
  CHECK(scaledBy(0.5 * base)[1] == doctest::Approx(2.0));

  // Derivatives by the base parameters themselves, of a torque of one.
  const Eigen::VectorXd torque = Eigen::VectorXd::Ones(2 * data.rows());
  Eigen::MatrixXd tangent = Eigen::MatrixXd::Zero(2 * data.rows(), base.size());
  scale.addSlopes(base, Eigen::MatrixXd::Identity(base.size(), base.size()), torque, tangent);
  for (Eigen::Index k = 0; k < base.size(); ++k) {
    CAPTURE(k);
    const Eigen::VectorXd step = 1e-5 * base.norm() * Eigen::VectorXd::Unit(base.size(), k);
    const Eigen::Vector2d slope = (scaledBy(base + step) - scaledBy(base - step)) / (2.0 * step.norm());
    CHECK(tangent(0, k) == 0.0);
    CHECK(tangent(data.rows(), k) == doctest::Approx(slope[1]).epsilon(1e-5));
  }
  CHECK(PassiveScale(data, regressor, base, {false, false}).isEmpty());
}

}  // namespace patella::diagnose
