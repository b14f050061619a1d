// How much may depend on something behind named effects.
#include "tools/diagnose/verdict/unknown_rest.hpp"

#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/recordings.hpp"

using namespace patella::diagnose;

namespace {

Dataset twoJoints() {
  Recording recording = swing(30.0);
  recording.joints = 2;
  recording.position_rad[1] = recording.position_rad[0];
  recording.torque_Nm[1] = recording.torque_Nm[0];
  return Dataset(std::span(&recording, 1), DatasetOptions{});
}

// Constant torques, so that each joint's root mean square is known.
Eigen::VectorXd torque(const Dataset& data, double first_Nm, double second_Nm) {
  Eigen::VectorXd values(2 * data.rows());
  values << Eigen::VectorXd::Constant(data.rows(), first_Nm),
      Eigen::VectorXd::Constant(data.rows(), second_Nm);
  return values;
}

std::vector<Dependence> dependence(int joint, double explained_Nm) {
  return {{.joint = joint, .variable = "q1", .explained_Nm = explained_Nm, .p_value = 0.001}};
}

std::vector<EffectFinding> named(int joint) {
  EffectFinding finding;
  finding.joint = joint;
  return {finding};
}

}  // namespace

TEST_CASE(
    "of the rest behind a named effect a fifth of the missing torque is unknown, or less that is no noise") {
  const Dataset data = twoJoints();
  const MissingTorque missing{.missing = torque(data, 2.0, 1.0), .left = torque(data, 1.0, 1.0)};
  CHECK_FALSE(restIsUnknown(data, missing, named(0), dependence(0, 0.3)));
  CHECK(restIsUnknown(data, missing, named(0), dependence(0, 0.34)));
  const MissingTorque large{.missing = torque(data, 8.0, 1.0), .left = torque(data, 1.0, 1.0)};
  CHECK_FALSE(restIsUnknown(data, large, named(0), dependence(0, 0.39)));
  CHECK(restIsUnknown(data, large, named(0), dependence(0, 0.41)));
  const MissingTorque slight{.missing = torque(data, 1.2, 1.0), .left = torque(data, 1.0, 1.0)};
  CHECK(restIsUnknown(data, slight, named(0), dependence(0, 0.3)));
}

TEST_CASE("a joint's small rest is held against what was named on the other, too") {
  const Dataset data = twoJoints();
  const MissingTorque missing{.missing = torque(data, 3.0, 1.0), .left = torque(data, 1.0, 1.0)};
  CHECK(restIsUnknown(data, missing, {}, dependence(1, 0.3)));
  CHECK(restIsUnknown(data, missing, named(1), dependence(1, 0.3)));
  CHECK_FALSE(restIsUnknown(data, missing, named(0), dependence(1, 0.3)));
  CHECK(restIsUnknown(data, missing, named(0), dependence(1, 0.4)));
}

TEST_CASE("where nothing depends on anything nothing is unknown") {
  const Dataset data = twoJoints();
  const MissingTorque missing{.missing = torque(data, 3.0, 1.0), .left = torque(data, 1.0, 1.0)};
  CHECK_FALSE(restIsUnknown(data, missing, named(0), {}));
}
