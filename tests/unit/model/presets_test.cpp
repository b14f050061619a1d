#include "core/model/presets.hpp"

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::model;

TEST_CASE("the paper's leg has the paper's base parameters") {
  const BaseParameters values = PlanarTwoLink(paperLeg().parameters).baseParameters();
  CHECK(values[0] == doctest::Approx(2.0 * 0.2 * 0.2 / 2.0 + 0.85 * 0.2 * 0.2));  // rod-like: I + m l²/4
  CHECK(values[1] == doctest::Approx(0.85 * 0.25 * 0.25 / 2.0));
  CHECK(values[2] == doctest::Approx(0.85 * 0.2 * 0.125));
  CHECK(values[3] == doctest::Approx(2.0 * 0.1 + 0.85 * 0.2));
  CHECK(values[4] == doctest::Approx(0.85 * 0.125));
  CHECK(paperLeg().viscous_Nms_rad == 0.2);
  CHECK(physicalLeg().viscous_Nms_rad == 0.05);
}

TEST_CASE("the adult leg is a human's") {
  const PlanarTwoLinkParameters leg = adultLeg().parameters;
  CHECK(leg.mass_kg[0] > 7.0);
  CHECK(leg.mass_kg[0] < 9.0);
  CHECK(leg.mass_kg[1] > 3.5);
  CHECK(leg.mass_kg[1] < 4.5);
  // Torque that holds the shank level: 4.39 kg at 0.242 m.
  CHECK(PlanarTwoLink(leg).gravity(JointVector::Zero(2))[1] == doctest::Approx(10.44).epsilon(1e-3));
}

TEST_CASE("a preset's model has its friction on both joints") {
  const DynamicsModel model = makeModel(paperLeg());
  const Eigen::Vector2d rate(1.5, -2.0);
  JointVector torque = JointVector::Zero(2);
  for (const auto& effect : model.effects()) {
    torque += effect->torque({.q = JointVector::Zero(2), .dq = rate, .torque_Nm = JointVector::Zero(2)});
  }
  CHECK(torque.isApprox(-0.2 * rate, 1e-14));
}
