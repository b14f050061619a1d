// Findings in recordings of other people's machines and of a person. Bounds are a little
// above what was reached, which stands in docs/measured_diagnosis.md.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/files/model_file.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/diagnose/checks/drive_timing.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/recordings/recording_file.hpp"
#include "tools/studies/measured/emps_error.hpp"

using namespace patella;
using diagnose::Diagnosis;
using diagnose::EffectFinding;
using diagnose::Verdict;

namespace {

const std::filesystem::path kSource(checkout::source());
const std::filesystem::path kMaps = kSource / "tools/diagnose/maps";
const std::filesystem::path kData(checkout::recordings());

std::vector<diagnose::Recording> load(const std::vector<std::string>& files, const char* map, int joints) {
  std::vector<diagnose::Recording> recordings;
  for (const std::string& file : files) {
    recordings.push_back(diagnose::loadRecording(kData / file, {.joints = joints, .columns = kMaps / map}));
  }
  return recordings;
}

const EffectFinding* find(const Diagnosis& diagnosis, std::string_view kind, int joint) {
  const auto found =
      std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                   [=](const auto& effect) { return effect.kind == kind && effect.joint == joint; });
  return found == diagnosis.effects.end() ? nullptr : &*found;
}

double value(const EffectFinding* effect, std::string_view name) {
  REQUIRE(effect != nullptr);
  const auto found = std::find_if(effect->parameters.begin(), effect->parameters.end(),
                                  [=](const auto& parameter) { return parameter.name == name; });
  REQUIRE(found != effect->parameters.end());
  return found->value;
}

bool refusedForSign(const Diagnosis& diagnosis, const std::string& label, const std::string& parameter) {
  return std::any_of(
      diagnosis.steps.begin(), diagnosis.steps.end(), [&](const diagnose::SelectionStep& step) {
        return std::any_of(step.ranking.begin(), step.ranking.end(),
                           [&](const diagnose::CandidateScore& score) {
                             return score.label == label && score.refused_because == "sign: " + parameter &&
                                    score.gain > score.threshold;
                           });
      });
}

void checkAxis(const Diagnosis& diagnosis, const diagnose::Recording& recording) {
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  const EffectFinding* friction = find(diagnosis, "asymmetric_friction", 0);
  // The carriage rubs about a third more in one direction than in the other: 169 and 239 N·s/m in plain least
  // squares.
  const double one = value(friction, "viscous_positive_Nms_rad");
  const double other = value(friction, "viscous_negative_Nms_rad");
  CHECK(one > 130.0);
  CHECK(one < 200.0);
  CHECK(other > 1.2 * one);
  CHECK(other < 1.7 * one);
  // Its maker's identification has 20.4 N.
  for (const char* level : {"level_positive_Nm", "level_negative_Nm"}) {
    CHECK(value(friction, level) == doctest::Approx(20.0).epsilon(0.15));
  }
  const EffectFinding* lag = find(diagnosis, "actuator_lag", 0);
  const EffectFinding* late = lag != nullptr ? lag : find(diagnosis, "actuator_delay", 0);
  REQUIRE(late != nullptr);
  CHECK(late->parameters.front().value > 1e-4);
  CHECK(late->parameters.front().value < 6e-4);
  // Less than half a sample may as well be the reader's.
  CHECK_FALSE(late->asserted());
  // Friction that grows at low speed is no Stribeck friction.
  CHECK(find(diagnosis, "stribeck_friction", 0) == nullptr);
  CHECK(refusedForSign(diagnosis, "stribeck_friction@1", "stribeck_level_Nm"));

  const study::RelativeError error = study::relativeError(recording, diagnosis.extended, 0.7);
  CHECK(error.train_percent < 2.5);
  CHECK(error.heldout_percent < 2.7);
}

}  // namespace

TEST_CASE("EMPS, told of its inertia only: asymmetric friction, and a drive that is late") {
  const std::vector<diagnose::Recording> recordings = load({"emps/emps.csv"}, "emps.toml", 1);
  const Diagnosis diagnosis =
      diagnose::diagnose(recordings, {}, app::loadModel(kMaps / "emps_inertia.toml"), {});
  checkAxis(diagnosis, recordings.front());
}

TEST_CASE("EMPS, told of symmetric friction: what is found takes its place") {
  const std::vector<diagnose::Recording> recordings = load({"emps/emps.csv"}, "emps.toml", 1);
  const Diagnosis diagnosis =
      diagnose::diagnose(recordings, {}, app::loadModel(kMaps / "emps_symmetric.toml"), {});
  checkAxis(diagnosis, recordings.front());
  const EffectFinding* friction = find(diagnosis, "asymmetric_friction", 0);
  CHECK(friction->replaces == std::vector<std::string>{"viscous_friction", "coulomb_friction"});
  const auto& effects = diagnosis.extended.effects;
  CHECK(std::none_of(effects.begin(), effects.end(),
                     [](const auto& effect) { return effect.kind == "viscous_friction"; }));
  CHECK(find(diagnosis, "torque_bias", 0) == nullptr);
}

TEST_CASE("two-link arm, told of its rigid body: friction of both joints, and the rotor that can be told") {
  const std::string folder = "double_pendulum/";
  const std::vector<diagnose::Recording> train =
      load({folder + "run_1.csv", folder + "run_2.csv"}, "double_pendulum.toml", 2);
  const std::vector<diagnose::Recording> unseen = load({folder + "run_3.csv"}, "double_pendulum.toml", 2);
  const Diagnosis diagnosis = diagnose::diagnose(
      train, unseen, app::loadModel(kSource / "firmware_app/config/models/double_pendulum.toml"), {});
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  // Published 0.16 and 0.12 N·m.
  const double hip_Nm = value(find(diagnosis, "coulomb_friction", 0), "level_Nm");
  CHECK(hip_Nm > 0.15);
  CHECK(hip_Nm < 0.3);
  const double knee_Nm = value(find(diagnosis, "coulomb_friction", 1), "level_Nm");
  CHECK(knee_Nm > 0.12);
  CHECK(knee_Nm < 0.2);
  // Published 0.0023 kg·m²; that of joint 1 is the first link's inertia.
  const double rotor = value(find(diagnosis, "rotor_inertia", 1), "inertia_kg_m2");
  CHECK(rotor > 0.0014);
  CHECK(rotor < 0.0032);
  CHECK(find(diagnosis, "rotor_inertia", 0) == nullptr);
  CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.5 * diagnosis.before.heldout_rms_Nm[0]);
  CHECK(diagnosis.after.heldout_rms_Nm[1] < 0.55 * diagnosis.before.heldout_rms_Nm[1]);
}

TEST_CASE("two-link arm: its drives are late by some milliseconds, a delay and a lag") {
  const std::vector<diagnose::Recording> run = load({"double_pendulum/run_3.csv"}, "double_pendulum.toml", 2);
  const std::vector<diagnose::DriveTiming> timing = diagnose::driveTiming(run);
  REQUIRE(timing.size() == 2);
  for (const diagnose::DriveTiming& drive : timing) {
    CHECK(drive.delay_s > 0.001);
    CHECK(drive.delay_s < 0.004);
    CHECK(drive.delay_s + drive.lag_s > 0.007);
    CHECK(drive.delay_s + drive.lag_s < 0.011);
    CHECK(drive.relative_error_after < 0.35 * drive.relative_error_before);
  }
}

TEST_CASE("passive knee: the double exponential with its dependence on the hip") {
  const auto diagnosed = [](const char* map, const char* model, int joints) {
    return diagnose::diagnose(load({"passive_knee/silder_2007.csv"}, map, joints), {},
                              app::loadModel(kMaps / model), {});
  };
  SUBCASE("one posture of hip and ankle") {
    const Diagnosis diagnosis = diagnosed("passive_knee.toml", "passive_knee_model.toml", 1);
    CHECK(diagnosis.verdict == Verdict::kEffectFound);
    CHECK(find(diagnosis, "passive_knee_moment", 0) != nullptr);
    CHECK(diagnosis.after.heldout_rms_Nm[0] < 0.06 * diagnosis.before.heldout_rms_Nm[0]);
  }
  SUBCASE("two postures of the hip, the ankle in one") {
    const Diagnosis diagnosis = diagnosed("passive_leg_ankle_20.toml", "passive_leg_model.toml", 2);
    CHECK(diagnosis.verdict == Verdict::kEffectFound);
    const EffectFinding* knee = find(diagnosis, "passive_knee_moment", 1);
    // A straighter hip stretches the rectus femoris: more torque against flexion.
    CHECK(value(knee, "flexion_hip_1_rad") < 0.0);
    CHECK(value(knee, "extension_hip_1_rad") > 0.0);
    CHECK(diagnosis.after.heldout_rms_Nm[1] < 0.04 * diagnosis.before.heldout_rms_Nm[1]);
  }
  SUBCASE("all postures, in which the ankle's is not told") {
    const Diagnosis diagnosis = diagnosed("passive_leg.toml", "passive_leg_model.toml", 2);
    CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
    REQUIRE_FALSE(diagnosis.unexplained.empty());
    // The ankle changed from one series of postures to the next.
    CHECK(diagnosis.unexplained.front().variable == "order");
    REQUIRE(diagnosis.effects.size() == 1);
    CHECK(diagnosis.effects.front().kind == "passive_knee_moment");
    CHECK(diagnosis.after.heldout_rms_Nm[1] < 0.25 * diagnosis.before.heldout_rms_Nm[1]);
  }
}

TEST_CASE("a free pendulum, under no torque all along, tells its friction") {
  diagnose::DiagnoseOptions options;
  options.effects = {"viscous_friction", "coulomb_friction", "linear_stiffness", "rotor_inertia"};
  const Diagnosis diagnosis = diagnose::diagnose(
      load({"measured/multiarm_pendulum/map_single_free_1kHz.csv"}, "free_pendulum.toml", 1), {},
      app::loadModel(kMaps / "free_pendulum_model.toml"), options);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK((find(diagnosis, "viscous_friction", 0) != nullptr ||
         find(diagnosis, "coulomb_friction", 0) != nullptr));
  CHECK(diagnosis.after.heldout_rms_Nm[0] < diagnosis.before.heldout_rms_Nm[0]);
}

TEST_CASE("a free triple pendulum, a chain without drives: its authors' parameters, and no effect asserted") {
  const Diagnosis diagnosis = diagnose::diagnose(
      load({"measured/multiarm_pendulum/map_triple_free_1kHz.csv"}, "free_triple_pendulum.toml", 3), {},
      app::loadModel(kMaps / "free_triple_pendulum_model.toml"), {});
  CHECK(std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                     [](const EffectFinding& effect) { return effect.asserted(); }));
  // What is left of the gravity torque, 2.6 to 3.0 %, is more than sensors make.
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  for (std::size_t joint = 0; joint < 3; ++joint) {
    CHECK(diagnosis.refitted.heldout_rms_Nm[joint] <= diagnosis.before.heldout_rms_Nm[joint]);
    CHECK(diagnosis.after.heldout_rms_Nm[joint] <= diagnosis.before.heldout_rms_Nm[joint]);
  }
  // Of nine base parameters the three MY are no parameters of rods along x.
  REQUIRE(diagnosis.nominal.size() == 6);
  // Published ones lie in the intervals, which are as wide as a rest beyond noise allows.
  constexpr double kWithin = diagnose::asserted::kShapeAllowance * diagnose::kDeviations95;
  for (const diagnose::RefittedParameter& parameter : diagnosis.nominal) {
    CHECK(parameter.refitted == doctest::Approx(parameter.nominal).epsilon(0.02));
    CHECK(std::abs(parameter.refitted - parameter.nominal) < kWithin * parameter.sd);
    CHECK_FALSE(parameter.isBeyond());
  }
}

TEST_CASE("an arm that hardly moves, one joint of it without current, tells next to nothing") {
  const Diagnosis diagnosis =
      diagnose::diagnose(load({"measured/dfki_double_pendulum_c1/c1_144003.csv"}, "double_pendulum.toml", 2),
                         {}, app::loadModel(kSource / "firmware_app/config/models/double_pendulum.toml"), {});
  // What is left, 0.41 of 0.56 N·m on the first joint, may be told as too poor a motion or as unknown.
  CHECK((diagnosis.verdict == Verdict::kInsufficientExcitation ||
         diagnosis.verdict == Verdict::kUnknownEffect));
  CHECK(std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                     [](const EffectFinding& effect) { return effect.asserted(); }));
}
