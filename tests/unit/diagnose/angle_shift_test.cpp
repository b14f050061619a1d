// The regressor as a function of an encoder's offset against the regressor at that offset.
#include "tools/diagnose/fit/angle_shift.hpp"

#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "core/model/model_description.hpp"
#include "tests/unit/diagnose/recordings.hpp"
#include "tests/unit/model/chains.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

/// Every joint swings by itself, so that all of them couple.
Recording swingAll(int joints) {
  Recording recording = swing(8.0);
  recording.joints = joints;
  for (int joint = 1; joint < joints; ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    for (const double t : recording.time_s) {
      recording.position_rad[j].push_back(0.3 * joint + 0.5 * std::sin((2.0 + joint) * t));
    }
    recording.torque_Nm[j] = recording.torque_Nm[0];
  }
  return recording;
}

void checkEveryOffset(const model::MechanismDescription& mechanism, int joints) {
  const Dataset data(std::array{swingAll(joints)}, DatasetOptions{});
  const model::DynamicsModel dynamics = model::makeModel({.mechanism = mechanism, .effects = {}});
  const Eigen::MatrixXd unshifted = data.regressor(dynamics.mechanism(), JointVector::Zero(joints));
  for (int joint = 0; joint < joints; ++joint) {
    const bool slides = model::isPrismatic(mechanism, joint);
    const AngleShift shift = AngleShift::ofRegressor(data, dynamics.mechanism(), joint, slides);
    const AngleShift of_torque = AngleShift::ofTorque(data, dynamics.mechanism(), joint, slides);
    for (const double size : {-3.1, -0.25, -0.013, 0.0, 1e-4, 0.21, 1.7}) {
      CAPTURE(joint);
      CAPTURE(size);
      JointVector offset = JointVector::Zero(joints);
      offset[joint] = size;
      const Eigen::MatrixXd direct = data.regressor(dynamics.mechanism(), offset) - unshifted;
      CHECK((shift.at(size) - direct).norm() < 1e-9 * unshifted.norm());
      const Eigen::VectorXd torque = direct * dynamics.mechanism().baseParameters();
      CHECK((of_torque.at(size) - torque).norm() <
            1e-9 * (unshifted * dynamics.mechanism().baseParameters()).norm());
    }
  }
}

}  // namespace

TEST_CASE("an offset gives what a leg there gives") {
  const model::PlanarTwoLinkParameters leg{
      .mass_kg = {8.0, 4.0}, .length_m = {0.4, 0.45}, .com_m = {0.18, 0.2}, .inertia_kg_m2 = {0.1, 0.06}};
  checkEveryOffset(leg, 2);
}

TEST_CASE(
    "an offset gives what a chain there gives, where joints turn in any direction and where they slide") {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    checkEveryOffset(test::RandomChains(seed).draw(5), 5);
  }
}
