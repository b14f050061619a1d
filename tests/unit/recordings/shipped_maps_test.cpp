// Other people's measurements through the shipped maps.
#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "core/model/effect.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/recordings/recording_file.hpp"
#include "tools/signals/signals.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

Recording shipped(const std::string& map, int joints, const std::string& file) {
  const std::string maps = checkout::source() / "tools/diagnose/maps/";
  return loadRecording(checkout::recordings() / file, {.joints = joints, .columns = maps + map + ".toml"});
}

model::ModelDescription shippedModel(const std::string& name) {
  return app::loadModel(checkout::source() / "tools/diagnose/maps" / (name + ".toml"));
}

/// Torque of a joint of the model against that of the drives, as a correlation.
double agreement(const Recording& recording, const model::ModelDescription& description, std::size_t joint) {
  constexpr double kBand_Hz = 8.0;
  const model::DynamicsModel model = model::makeModel(description);
  std::array<offline::Samples, kMaxJoints> q, dq, ddq;
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    q[j] = offline::zeroPhaseLowPass(recording.position_rad[j], kBand_Hz, recording.rate_Hz);
    dq[j] = offline::derivative(q[j], recording.rate_Hz);
    ddq[j] = offline::derivative(dq[j], recording.rate_Hz);
  }
  offline::Samples predicted;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    model::EffectInput state;
    JointVector acceleration(recording.joints);
    state.q = state.dq = state.torque_Nm = JointVector::Zero(recording.joints);
    for (int j = 0; j < recording.joints; ++j) {
      state.q[j] = q[static_cast<std::size_t>(j)][i];
      state.dq[j] = dq[static_cast<std::size_t>(j)][i];
      acceleration[j] = ddq[static_cast<std::size_t>(j)][i];
    }
    predicted.push_back(model.inverseDynamics(state, acceleration)[static_cast<Eigen::Index>(joint)]);
  }
  return offline::correlation(
      predicted, offline::zeroPhaseLowPass(recording.torque_Nm[joint], kBand_Hz, recording.rate_Hz));
}

}  // namespace

TEST_CASE("the linear axis: signs and units are those of its published model") {
  const Recording recording = shipped("emps", 1, "emps/emps.csv");
  CHECK(recording.rate_Hz == 1000.0);
  CHECK(recording.rows() == 24841);
  CHECK(recording.segments.size() == 1);
  CHECK(agreement(recording, shippedModel("emps_symmetric"), 0) > 0.99);
  CHECK(agreement(recording, shippedModel("emps_inertia"), 0) < 0.9);
}

TEST_CASE("the arm: hanging is −90°, and its rigid body explains most of the torque") {
  const auto model = app::loadModel(checkout::source() / "firmware_app/config/models/double_pendulum.toml");
  for (const char* run : {"run_1", "run_2", "run_3"}) {
    CAPTURE(run);
    const Recording recording = shipped("double_pendulum", 2, std::string("double_pendulum/") + run + ".csv");
    CHECK(recording.rate_Hz == 500.0);
    CHECK(recording.torque_timing == TorqueTiming::kSampled);
    CHECK(recording.commanded_Nm[1].size() == recording.rows());
    CHECK(recording.position_rad[0][0] == doctest::Approx(-1.5708).epsilon(0.001));
    Recording unshifted = recording;
    for (double& q : unshifted.position_rad[0]) {
      q += 1.5707963267948966;
    }
    CHECK(agreement(recording, model, 0) > 0.65);
    CHECK(agreement(recording, model, 1) > 0.55);
    CHECK(agreement(unshifted, model, 1) < 0.35);
  }
}

TEST_CASE(
    "the passive knee: a drive holds against the tissues, which bend a straight knee and straighten a bent "
    "one") {
  const Recording recording = shipped("passive_knee", 1, "passive_knee/silder_2007.csv");
  CHECK(recording.is_static);
  CHECK(recording.rows() == 121);
  const auto& q = recording.position_rad[0];
  const auto& torque = recording.torque_Nm[0];
  CHECK(*std::max_element(q.begin(), q.end()) == doctest::Approx(0.0));
  CHECK(*std::min_element(q.begin(), q.end()) == doctest::Approx(-2.094).epsilon(0.001));
  // The library's own formula, with its published numbers and an ankle at rest, must have the same sign at
  // both ends.
  const model::ModelDescription model = shippedModel("passive_knee_model");
  const model::DynamicsModel dynamics = model::makeModel(model);
  const model::EffectDescriptor& kind = *model::findEffect("passive_knee_moment");
  std::vector<double> published;
  for (const model::EffectParameter& parameter : kind.parameters) {
    published.push_back(parameter.initial);
  }
  const auto effect = model::makeEffect(kind.kind, 0, dynamics.mechanism(), published);
  for (const std::size_t i : {std::size_t{0}, recording.rows() - 1}) {
    model::EffectInput state;
    state.q = JointVector::Constant(1, q[i]);
    state.dq = state.torque_Nm = JointVector::Zero(1);
    CAPTURE(q[i]);
    CHECK(effect->torque(state)[0] * torque[i] < 0.0);
  }
}
