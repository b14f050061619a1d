// Effects that depend on torque are driven by what motion asks for, not by what was measured.
#include "tools/diagnose/fit/predicted_torque.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "core/model/effect.hpp"
#include "tests/unit/diagnose/recordings.hpp"
#include "tools/diagnose/diagnose.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

constexpr double kInertia_kg_m2 = 0.4;
constexpr double kMoment_kg_m = 0.5;
const model::ModelDescription kModel{
    .mechanism =
        model::RevoluteJointParameters{
            .inertia_kg_m2 = kInertia_kg_m2, .moment_kg_m = kMoment_kg_m, .length_m = 0.4},
    .effects = {}};

// The swing's own torque, which the model knows, and a viscous friction, which it does not.
Recording damped() {
  constexpr double kViscous_Nms_rad = 0.8;
  Recording recording = swing(20.0);
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double q = recording.position_rad[0][i];
    const double dq = std::numbers::pi * std::cos(std::numbers::pi * recording.time_s[i]);
    recording.torque_Nm[0][i] = -kInertia_kg_m2 * std::numbers::pi * std::numbers::pi * q +
                                kMoment_kg_m * 9.81 * std::cos(q) + kViscous_Nms_rad * dq;
  }
  return recording;
}

double rms(const Eigen::VectorXd& values) {
  return values.norm() / std::sqrt(static_cast<double>(values.size()));
}

Eigen::VectorXd predictedTorque(const Dataset& data) {
  return data.variable([](const Series& s, std::size_t i) { return s.states[i].torque_Nm[0]; });
}

}  // namespace

TEST_CASE("the predicted torque is the drive's, with friction that the model does not have") {
  Dataset data(std::array{damped()}, DatasetOptions{});
  const Eigen::VectorXd measured = data.driveTorque();
  TorquePrediction(data, kModel, {}).predict(data);
  CHECK(rms(predictedTorque(data) - measured) < 0.02 * rms(measured));
}

TEST_CASE("what drives the effects of data that were not fitted does not follow their measured torque") {
  const Dataset train(std::array{damped()}, DatasetOptions{});
  Recording other = damped();
  for (double& torque_Nm : other.torque_Nm[0]) {
    torque_Nm = 0.0;
  }
  Dataset heldout(std::array{other}, DatasetOptions{});
  TorquePrediction(train, kModel, {}).predict(heldout);
  CHECK(rms(predictedTorque(heldout) - train.driveTorque()) < 0.02 * rms(train.driveTorque()));

  const model::DynamicsModel bare = model::makeModel(kModel);
  constexpr double kCoefficient = 0.1, kSmoothing_rad_s = 0.01;
  const auto friction = model::makeEffect("load_dependent_friction", 0, bare.mechanism(),
                                          std::array{kCoefficient, kSmoothing_rad_s});
  CHECK(rms(heldout.effectTorque(*friction)) > 0.5 * kCoefficient * rms(train.driveTorque()));
}

TEST_CASE("a torque of amplitudes at random against the motion is no friction of the load") {
  std::mt19937_64 random(20260117);
  std::uniform_real_distribution<double> amplitude_Nm(0.0, 12.0);
  Recording recording = damped();
  double level_Nm = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const double dq = std::cos(std::numbers::pi * recording.time_s[i]);
    if (i == 0 || (dq > 0.0) != (last > 0.0)) {
      level_Nm = amplitude_Nm(random);
    }
    last = dq;
    recording.torque_Nm[0][i] = level_Nm * std::tanh(20.0 * dq);
  }
  const Diagnosis diagnosis = diagnose::diagnose(std::array{recording}, {}, kModel, {});
  CHECK(diagnosis.verdict != Verdict::kNothingMissing);
  CHECK(std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                     [](const EffectFinding& effect) { return effect.kind == "load_dependent_friction"; }));
}
