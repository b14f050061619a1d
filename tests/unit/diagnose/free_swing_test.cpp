// A pendulum that nobody drives, whose torque column is not quite zero.
#include <cmath>

#include <doctest/doctest.h>

#include "tools/diagnose/diagnose.hpp"

namespace patella::diagnose {
namespace {

constexpr double kInertia_kg_m2 = 0.02, kMoment_kg_m = 0.08, kGravity_m_s2 = 9.81;

/// It swings freely for half a minute, held up by what little it loses; angles from the horizontal. The
/// model's moment is 1 % off, as measured ones are. `torque_Nm`: what the column has, by velocity.
template <class Torque>
Recording swinging(Torque torque_Nm) {
  constexpr double kRate_Hz = 200.0;
  constexpr int kSteps = 20;
  Recording recording;
  recording.name = "swinging";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  double q = 0.1, dq = 0.0;
  for (int i = 0; i < static_cast<int>(30.0 * kRate_Hz); ++i) {
    recording.time_s.push_back(i / kRate_Hz);
    recording.position_rad[0].push_back(q);
    recording.torque_Nm[0].push_back(torque_Nm(dq));
    for (int k = 0; k < kSteps; ++k) {
      const double h = 1.0 / (kRate_Hz * kSteps);
      dq -= h * 1.01 * kMoment_kg_m * kGravity_m_s2 * std::cos(q) / kInertia_kg_m2;
      q += h * dq;
    }
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

Diagnosis diagnosed(const Recording& recording) {
  const model::ModelDescription model{
      .mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = kInertia_kg_m2,
                                                  .moment_kg_m = kMoment_kg_m,
                                                  .length_m = 0.3,
                                                  .gravity_m_s2 = kGravity_m_s2},
      .effects = {}};
  return diagnose(std::span(&recording, 1), {}, model, {});
}

void checkThatMassesStay(const Diagnosis& diagnosis) {
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    CAPTURE(parameter.name);
    CHECK(parameter.refitted == doctest::Approx(parameter.nominal).epsilon(0.05));
  }
}

}  // namespace

TEST_CASE("what a free pendulum's torque sensor shows does not tell its masses") {
  const Diagnosis diagnosis = diagnosed(swinging([](double) { return 0.01; }));
  checkThatMassesStay(diagnosis);
}

TEST_CASE("damping of a free pendulum is found with its masses as they are") {
  const Diagnosis diagnosis = diagnosed(swinging([](double dq) { return 0.004 * dq; }));
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  REQUIRE_FALSE(diagnosis.effects.empty());
  CHECK(diagnosis.effects.front().kind == "viscous_friction");
  CHECK(diagnosis.effects.front().parameters.front().value == doctest::Approx(0.004).epsilon(0.05));
  checkThatMassesStay(diagnosis);
}

}  // namespace patella::diagnose
