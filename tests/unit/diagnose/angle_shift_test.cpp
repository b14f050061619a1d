// The polynomial in an encoder's offset against the regressor itself.
#include "tools/diagnose/fit/angle_shift.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "core/model/model_description.hpp"
#include "tests/unit/diagnose/recordings.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE("an offset between the nodes gives what the mechanism there gives") {
  Recording recording = swing(8.0);
  recording.joints = 2;
  recording.position_rad[1] = recording.position_rad[0];
  std::reverse(recording.position_rad[1].begin(), recording.position_rad[1].end());
  recording.torque_Nm[1] = recording.torque_Nm[0];
  const Dataset data(std::array{recording}, DatasetOptions{});
  const model::PlanarTwoLinkParameters leg{
      .mass_kg = {8.0, 4.0}, .length_m = {0.4, 0.45}, .com_m = {0.18, 0.2}, .inertia_kg_m2 = {0.1, 0.06}};
  const model::DynamicsModel dynamics = model::makeModel({.mechanism = leg, .effects = {}});
  const Eigen::MatrixXd unshifted = data.regressor(dynamics.mechanism(), JointVector::Zero(2));
  for (const int joint : {0, 1}) {
    const AngleShift shift(data, dynamics.mechanism(), joint);
    for (const double angle_rad : {-0.25, -0.013, 0.0, 1e-4, 0.21, AngleShift::kFarthest_rad}) {
      CAPTURE(joint);
      CAPTURE(angle_rad);
      JointVector offset_rad = JointVector::Zero(2);
      offset_rad[joint] = angle_rad;
      const Eigen::MatrixXd direct = data.regressor(dynamics.mechanism(), offset_rad) - unshifted;
      CHECK((shift.at(angle_rad) - direct).norm() < 1e-10 * unshifted.norm());
      CHECK((angle_rad == 0.0 || direct.norm() > 0.01 * std::abs(angle_rad) * unshifted.norm()));
    }
  }
}
