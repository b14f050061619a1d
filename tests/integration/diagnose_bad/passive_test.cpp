// Limbs and machines that nobody drives: a leg that is let go is a test like any other.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include "tests/integration/diagnose_bad/spoilt_rigs.hpp"
#include "tools/diagnose/checks/plausibility.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

constexpr double kInertia_kg_m2 = 0.35, kMoment_kg_m = 1.5, kGravity_m_s2 = 9.81;

/// Torque that tissues exert at an angle (from the horizontal) and velocity.
using Tissue = std::function<double(double, double)>;

// A shank that is let go, straight, and swings below the knee; an encoder of 14 bits, no torque.
Recording dropped(const Tissue& tissue, double duration_s) {
  constexpr double kRate_Hz = 1000.0, kStep_rad = 2.0 * std::numbers::pi / 16384.0;
  constexpr int kSubsteps = 4;
  Recording recording;
  recording.name = "drop.csv";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  double q = -0.2, dq = 0.0;
  const auto acceleration = [&](double angle, double velocity) {
    return (tissue(angle, velocity) - kMoment_kg_m * kGravity_m_s2 * std::cos(angle)) / kInertia_kg_m2;
  };
  for (int i = 0; i < static_cast<int>(duration_s * kRate_Hz); ++i) {
    recording.time_s.push_back(i / kRate_Hz);
    recording.position_rad[0].push_back(kStep_rad * std::round(q / kStep_rad));
    recording.torque_Nm[0].push_back(0.0);
    for (int k = 0; k < kSubsteps; ++k) {
      // Midpoint rule.
      const double step_s = 1.0 / (kRate_Hz * kSubsteps);
      const double middle = dq + 0.5 * step_s * acceleration(q, dq);
      const double half = q + 0.5 * step_s * dq;
      dq += step_s * acceleration(half, middle);
      q += step_s * middle;
    }
  }
  recording.segments = {{.first = 0, .end = recording.rows()}};
  return recording;
}

model::ModelDescription shank() {
  return {.mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = kInertia_kg_m2,
                                                      .moment_kg_m = kMoment_kg_m,
                                                      .length_m = 0.4,
                                                      .gravity_m_s2 = kGravity_m_s2},
          .effects = {}};
}

bool names(const Diagnosis& diagnosis, const std::string& kind) {
  return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const EffectFinding& effect) {
    const auto& rivals = effect.indistinguishable_from;
    return effect.kind == kind || std::find(rivals.begin(), rivals.end(), kind) != rivals.end();
  });
}

}  // namespace

TEST_CASE("a leg that is let go tells its damping") {
  const Recording drop = dropped([](double, double dq) { return -0.25 * dq; }, 12.0);
  CHECK_NOTHROW(requirePlausible(std::span(&drop, 1), shank()));
  const Diagnosis diagnosis = diagnosed(std::span(&drop, 1), shank());
  CAPTURE(diagnosis.explanation);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK(names(diagnosis, "viscous_friction"));
}

TEST_CASE("a leg that is let go tells its stiffness, which moves it far from where the model has it") {
  for (const double stiffness_Nm_rad : {3.0, 6.0, 12.0}) {
    CAPTURE(stiffness_Nm_rad);
    const Recording drop =
        dropped([=](double q, double dq) { return -0.25 * dq - stiffness_Nm_rad * (q + 1.0); }, 12.0);
    CHECK_NOTHROW(requirePlausible(std::span(&drop, 1), shank()));
    const Diagnosis diagnosis = diagnosed(std::span(&drop, 1), shank());
    CAPTURE(diagnosis.explanation);
    CHECK(diagnosis.verdict == Verdict::kEffectFound);
    CHECK(names(diagnosis, "linear_stiffness"));
  }
}
