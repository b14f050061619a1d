#include "tools/diagnose/evidence/decision.hpp"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/model/effect.hpp"
#include "tests/support/swinging_joint.hpp"

namespace patella::diagnose::evidence {
namespace {

constexpr double kNoise_Nm = 0.05;

Diagnosis of(const std::function<double(const Motion&)>& missing) {
  const Recording recording = swinging(40.0, kNoise_Nm, missing);
  return decide(std::span(&recording, 1), pendulum(), {});
}

double sign(double x) {
  return x > 0.0 ? 1.0 : -1.0;
}

TEST_CASE("a model that lacks nothing lacks nothing") {
  const Diagnosis diagnosis = of([](const Motion&) { return 0.0; });
  CHECK(diagnosis.verdict == Verdict::kNothingMissing);
  CHECK(diagnosis.effects.empty());
}

TEST_CASE("dry friction is found, with its size") {
  const Diagnosis diagnosis = of([](const Motion& motion) { return 0.3 * sign(motion.dq); });
  REQUIRE(diagnosis.effects.size() == 1);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK(diagnosis.effects[0].kind == "coulomb_friction");
  REQUIRE(!diagnosis.effects[0].parameters.empty());
  CHECK(diagnosis.effects[0].parameters[0].name == "level_Nm");
  CHECK(diagnosis.effects[0].parameters[0].value == doctest::Approx(0.3).epsilon(0.05));
}

TEST_CASE("a declared effect that is not what was declared is no other effect") {
  model::ModelDescription model = pendulum();
  std::vector<double> parameters;
  for (const model::EffectParameter& parameter : model::findEffect("viscous_friction")->parameters) {
    parameters.push_back(parameter.name == "coefficient_Nms_rad" ? 0.2 : parameter.initial);
  }
  model.effects.push_back({.kind = "viscous_friction", .joint = 0, .parameters = parameters});
  const Recording recording = swinging(40.0, kNoise_Nm, [](const Motion& motion) { return 0.5 * motion.dq; });
  const Diagnosis diagnosis = decide(std::span(&recording, 1), model, {});
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  CHECK(diagnosis.effects.empty());
}

TEST_CASE("a spring that comes and goes, and a load that is taken up, are missing but not known") {
  for (const auto& missing : {std::function<double(const Motion&)>([](const Motion& motion) {
                                return (1.0 + std::sin(0.9 * motion.time_s)) * (motion.q - 0.2);
                              }),
                              std::function<double(const Motion&)>([](const Motion& motion) {
                                return motion.time_s > 21.0 ? 2.0 + 0.5 * motion.q : 0.0;
                              })}) {
    CHECK(of(missing).verdict == Verdict::kUnknownEffect);
  }
}

TEST_CASE("a torque of random size along the velocity is no load-dependent friction") {
  // Held for a tenth of a second each.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> size_Nm(400);
  for (double& value : size_Nm) {
    value = uniform(random);
  }
  Recording recording = swinging(40.0, kNoise_Nm, [](const Motion&) { return 0.0; });
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const Motion motion = motionAt(recording.time_s[i]);
    recording.torque_Nm[0][i] = size_Nm[static_cast<std::size_t>(motion.time_s * 10.0)] * sign(motion.dq);
  }
  const Diagnosis diagnosis = decide(std::span(&recording, 1), pendulum(), {});
  CHECK(diagnosis.verdict != Verdict::kNothingMissing);
  for (const EffectFinding& effect : diagnosis.effects) {
    CHECK(effect.kind != "load_dependent_friction");
  }
}

}  // namespace
}  // namespace patella::diagnose::evidence
