#include "tools/diagnose/verdict/excitation.hpp"

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/integration/diagnose_bad/spoilt_rigs.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

bool holds(const std::vector<std::string>& list, const std::string& phrase) {
  return std::any_of(list.begin(), list.end(),
                     [&](const std::string& item) { return item.find(phrase) != std::string::npos; });
}

void clip(std::vector<double>& torque, double share) {
  std::vector<double> sorted = torque;
  std::sort(sorted.begin(), sorted.end());
  const double most = sorted[static_cast<std::size_t>((1.0 - share) * static_cast<double>(sorted.size()))];
  for (double& value : torque) {
    value = std::min(value, most);
  }
}

}  // namespace

TEST_CASE("a sound recording is diagnosed, with what its motion can tell") {
  const SpoiltRig rig = rubbingRig("knee", 1);
  const Diagnosis diagnosis = diagnosed(std::array{rig.record()}, rig.model());
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK_FALSE(claimsSomethingElse(diagnosis));
  CHECK(holds(diagnosis.excitation.identifiable, "coulomb_friction@1"));
  CHECK(holds(diagnosis.excitation.identifiable, "nominal moment_kg_m"));
  REQUIRE(diagnosis.excitation.position_range_rad.size() == 1);
  CHECK(diagnosis.excitation.position_range_rad[0] > 0.5);
  CHECK(diagnosis.excitation.velocity_rms_rad_s[0] > 0.1);
}

TEST_CASE("constant signals tell nothing") {
  const SpoiltRig rig = rubbingRig("light_arm", 2);
  Recording recording = rig.record();
  for (std::size_t j = 0; j < 2; ++j) {
    std::fill(recording.position_rad[j].begin(), recording.position_rad[j].end(), -0.7);
    std::fill(recording.torque_Nm[j].begin(), recording.torque_Nm[j].end(), 1.1);
  }
  const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
  CHECK(diagnosis.verdict == Verdict::kInsufficientExcitation);
  CHECK(diagnosis.effects.empty());
  CHECK(diagnosis.explanation.find("No joint moves") == 0);
  CHECK(holds(diagnosis.excitation.not_identifiable, "joint 2 is at rest"));
}

TEST_CASE("a torque that never changes tells nothing, whatever moves") {
  const SpoiltRig rig = rubbingRig("knee", 1);
  for (const double value : {0.0, 2.5}) {
    Recording recording = rig.record();
    std::fill(recording.torque_Nm[0].begin(), recording.torque_Nm[0].end(), value);
    const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
    CHECK(diagnosis.verdict == Verdict::kInsufficientExcitation);
    CHECK(diagnosis.explanation.find("torque of joint 1 never changes") != std::string::npos);
  }
}

TEST_CASE("a joint at rest is named, and nothing is claimed of it") {
  SpoiltRig rig = rubbingRig("light_arm", 2);
  SUBCASE("held there by its drive") {
    rig.rig.reference[1].harmonics.clear();
  }
  Recording recording = rig.record();
  SUBCASE("by an encoder that stands still") {
    std::fill(recording.position_rad[1].begin(), recording.position_rad[1].end(),
              recording.position_rad[1][0]);
  }
  SUBCASE("by an encoder that stands still between two counts") {
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      recording.position_rad[1][i] = i % 7 < 3 ? 0.0 : rig.rig.encoder_step_rad[1];
    }
  }
  const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
  CAPTURE(diagnosis.explanation);
  CHECK_FALSE(claimsSomethingElse(diagnosis));
  CHECK(std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                     [](const EffectFinding& effect) { return effect.joint == 1; }));
  if (diagnosis.excitation.velocity_rms_rad_s[1] < 0.01 * diagnosis.excitation.velocity_rms_rad_s[0]) {
    CHECK(holds(diagnosis.excitation.not_identifiable, "joint 2 is at rest"));
    CHECK(holds(diagnosis.warnings, "joint 2 is at rest"));
  }
}

TEST_CASE("torque that is cut off") {
  const SpoiltRig rig = rubbingRig("knee", 1);
  Recording recording = rig.record();
  SUBCASE("in every tenth row tells nothing") {
    clip(recording.torque_Nm[0], 0.10);
    const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
    CHECK(diagnosis.verdict == Verdict::kInsufficientExcitation);
    CHECK(diagnosis.explanation.find("cut off") != std::string::npos);
    CHECK(diagnosis.effects.empty());
  }
  SUBCASE("now and then is said") {
    clip(recording.torque_Nm[0], 0.01);
    const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
    CHECK(holds(diagnosis.warnings, "the torque of joint 1 is cut off"));
    CHECK_FALSE(claimsSomethingElse(diagnosis));
  }
}

TEST_CASE("a single sinusoid is told from two") {
  SpoiltRig rig = rubbingRig("knee", 1);
  rig.rig.reference[0].harmonics = {{.amplitude_rad = 0.5, .frequency_Hz = 0.5, .phase_rad = 0.0}};
  Recording one = rig.record();
  const std::vector<JointSignals> single = jointSignals(std::span(&one, 1));
  CHECK(single[0].line_share > 0.97);
  CHECK(single[0].line_Hz == doctest::Approx(0.5).epsilon(0.03));
  Diagnosis diagnosis;
  describeMotion(single, diagnosis);
  CHECK(holds(diagnosis.warnings, "add a second frequency"));

  rig.rig.reference[0].harmonics.push_back({.amplitude_rad = 0.1, .frequency_Hz = 1.1, .phase_rad = 1.0});
  Recording two = rig.record();
  CHECK(jointSignals(std::span(&two, 1))[0].line_share < 0.97);
  // Each by itself is a single sinusoid; together they are not.
  rig.rig.reference[0].harmonics = {{.amplitude_rad = 0.3, .frequency_Hz = 0.9, .phase_rad = 0.0}};
  CHECK(jointSignals(std::array{one, rig.record()})[0].line_share < 0.97);
}
