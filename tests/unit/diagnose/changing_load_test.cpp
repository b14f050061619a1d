// What changes in the course of a recording, and what pulls at two joints alike: neither is noise.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/model/presets.hpp"
#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tools/diagnose/diagnose.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

constexpr double kDuration_s = 24.0;
constexpr double kNoise_Nm = 0.05;

model::ModelDescription knee(double load_kg) {
  constexpr double kArm_m = 0.35;
  return {.mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = 0.35 + load_kg * kArm_m * kArm_m,
                                                      .moment_kg_m = 1.1 + load_kg * kArm_m,
                                                      .length_m = 0.4},
          .effects = {}};
}

/// The torque of `other` in the stretch between two shares of the recording. Both move alike.
Recording with(Recording recording, const Recording& other, double from, double to) {
  const auto rows = static_cast<double>(recording.rows());
  for (auto i = static_cast<std::size_t>(from * rows); i < static_cast<std::size_t>(to * rows); ++i) {
    recording.torque_Nm[0][i] = other.torque_Nm[0][i];
  }
  return recording;
}

Diagnosis diagnosed(const Recording& recording, const model::ModelDescription& model) {
  DiagnoseOptions options;
  options.bootstrap_replicates = 299;
  return diagnose::diagnose(std::span(&recording, 1), {}, model, options);
}

bool dependsOn(const Diagnosis& diagnosis, const std::string& variable) {
  return std::any_of(diagnosis.unexplained.begin(), diagnosis.unexplained.end(),
                     [&](const Dependence& found) { return found.variable == variable; });
}

}  // namespace

TEST_CASE("a load that is taken up half way is told from nothing, by what it changes with") {
  const Recording empty = moved(knee(0.0), kDuration_s, kNoise_Nm);
  CHECK(diagnosed(empty, knee(0.0)).verdict == Verdict::kNothingMissing);
  for (const double load_kg : {0.2, 0.5}) {
    CAPTURE(load_kg);
    const Recording loaded = moved(knee(load_kg), kDuration_s, kNoise_Nm);
    const Diagnosis diagnosis = diagnosed(with(empty, loaded, 0.45, 1.0), knee(0.0));
    CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
    CHECK(dependsOn(diagnosis, "torque1*time"));
  }
}

TEST_CASE("a load that is grasped and released is not nothing") {
  const Recording empty = moved(knee(0.0), kDuration_s, kNoise_Nm);
  const Recording loaded = moved(knee(0.5), kDuration_s, kNoise_Nm);
  CHECK(diagnosed(with(empty, loaded, 0.3, 0.55), knee(0.0)).verdict == Verdict::kUnknownEffect);
}

TEST_CASE("friction of a belt that pulls at two joints alike is not noise that they share") {
  const model::ModelDescription leg{.mechanism = model::adultLeg().parameters, .effects = {}};
  const Recording free = moved(leg, kDuration_s, kNoise_Nm);
  CHECK(diagnosed(free, leg).verdict == Verdict::kNothingMissing);
  Recording rubbing = free;
  constexpr double kLevel_Nm = 1.0;
  const auto& q = free.position_rad;
  for (std::size_t i = 1; i < free.rows(); ++i) {
    const double turned = q[0][i] - q[0][i - 1] + q[1][i] - q[1][i - 1];
    const double friction_Nm = kLevel_Nm * std::tanh(turned * free.rate_Hz / 0.02);
    rubbing.torque_Nm[0][i] += friction_Nm;
    rubbing.torque_Nm[1][i] += friction_Nm;
  }
  CHECK(diagnosed(rubbing, leg).verdict != Verdict::kNothingMissing);
}
