// Play in a gear whose contacts are not those that the library assumes.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::diagnose {
namespace {

struct Gear {
  double gap_rad = 0.02;
  double rotor_inertia_kg_m2 = 0.06;
  double contact_rad_s = 0.0;  ///< at which the rotor rings in a contact
  double damping_ratio = 0.0;
};

struct Body {
  double angle_rad = 0.0, rate_rad_s = 0.0;

  void push(double acceleration_rad_s2, double h_s) {
    rate_rad_s += h_s * acceleration_rad_s2;
    angle_rad += h_s * rate_rad_s;
  }
};

/// T, with which the gear's contacts push the link.
double transmitted_Nm(const Gear& gear, const Body& rotor, const Body& link) {
  const double twist_rad = rotor.angle_rad - link.angle_rad;
  const double beyond_rad = twist_rad - std::clamp(twist_rad, -0.5 * gear.gap_rad, 0.5 * gear.gap_rad);
  const double stiffness_Nm_rad = gear.rotor_inertia_kg_m2 * gear.contact_rad_s * gear.contact_rad_s;
  const double damping_Nms_rad = 2.0 * gear.damping_ratio * gear.rotor_inertia_kg_m2 * gear.contact_rad_s;
  const double torque_Nm =
      stiffness_Nm_rad * beyond_rad + damping_Nms_rad * (rotor.rate_rad_s - link.rate_rad_s);
  return torque_Nm * beyond_rad > 0.0 ? torque_Nm : 0.0;
}

/// pendulum(), hanging, whose position is held to a motion by a motor behind the gear. 500 Hz, in
/// steps of 20 µs.
Recording driven(const Gear& gear, double duration_s) {
  constexpr double kStep_s = 2e-5;
  constexpr int kSteps = 100;
  constexpr double kHanging_rad = -0.5 * std::numbers::pi;
  constexpr double kInertia_kg_m2 = 0.3, kWeight_Nm = 9.81;
  constexpr double kStiffness_Nm_rad = 150.0, kDamping_Nms_rad = 8.0;
  Recording recording;
  recording.name = "driven";
  recording.rate_Hz = 1.0 / (kStep_s * kSteps);
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kHeld;
  Body rotor{.angle_rad = kHanging_rad}, link = rotor;
  for (int i = 0; i < static_cast<int>(duration_s * recording.rate_Hz); ++i) {
    const Motion asked = motionAt(i / recording.rate_Hz);
    const double drive_Nm = kStiffness_Nm_rad * (kHanging_rad + asked.q - link.angle_rad) +
                            kDamping_Nms_rad * (asked.dq - link.rate_rad_s) +
                            kWeight_Nm * std::cos(link.angle_rad) + kInertia_kg_m2 * asked.ddq;
    recording.time_s.push_back(asked.time_s);
    recording.position_rad[0].push_back(link.angle_rad);
    recording.torque_Nm[0].push_back(drive_Nm);
    for (int k = 0; k < kSteps; ++k) {
      const double torque_Nm = transmitted_Nm(gear, rotor, link);
      link.push((torque_Nm - kWeight_Nm * std::cos(link.angle_rad)) / kInertia_kg_m2, kStep_s);
      rotor.push((drive_Nm - torque_Nm) / gear.rotor_inertia_kg_m2, kStep_s);
    }
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

/// pendulum() with the gear's rotor in its inertia.
model::ModelDescription rigid(const Gear& gear) {
  model::ModelDescription model = pendulum();
  std::get<model::RevoluteJointParameters>(model.mechanism).inertia_kg_m2 += gear.rotor_inertia_kg_m2;
  return model;
}

}  // namespace

TEST_CASE("play is found whatever its contacts are like, with the gap and the rotor in their intervals") {
  for (const auto& [contact_rad_s, damping_ratio] : {std::pair{250.0, 0.5}, std::pair{700.0, 0.4}}) {
    CAPTURE(contact_rad_s);
    const Gear gear{.contact_rad_s = contact_rad_s, .damping_ratio = damping_ratio};
    const Recording recording = driven(gear, 40.0);
    const Diagnosis diagnosis = diagnose(std::span(&recording, 1), {}, rigid(gear), {});
    CHECK(diagnosis.verdict == Verdict::kEffectFound);
    REQUIRE(diagnosis.effects.size() == 1);
    const EffectFinding& found = diagnosis.effects.front();
    CHECK(found.kind == "backlash");
    CHECK(found.asserted());
    for (const ParameterEstimate& estimate : found.parameters) {
      CAPTURE(estimate.name);
      const double truth = estimate.name == "gap_rad" ? gear.gap_rad : gear.rotor_inertia_kg_m2;
      CHECK(estimate.ci95[0] < truth);
      CHECK(estimate.ci95[1] > truth);
    }
    CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.6 * diagnosis.refitted.heldout_rms_Nm[0]);
  }
}

}  // namespace patella::diagnose
