// A joint under a position controller that moves from place to place: what friction and a person do at rest.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/fit/sticking.hpp"

namespace patella::diagnose {
namespace {

struct Held {
  double move_s = 1.5;
  double rest_s = 1.5;
  double friction_Nm = 0.0;
  double push_rms_Nm = 0.0;  ///< of a person, below 1 Hz
};

constexpr double kRate_Hz = 1000.0;
constexpr int kStepsPerSample = 10;

/// Moves without jerk at both ends.
Motion placed(const Held& held, double time_s) {
  const double period_s = held.move_s + held.rest_s;
  const double move = std::floor(time_s / period_s);
  const auto place = [](double number) { return -1.2 + 0.7 * std::sin(2.4 * number * number + 0.3); };
  const double way = place(move + 1.0) - place(move);
  const double x = std::min(1.0, (time_s - move * period_s) / held.move_s);
  return {.time_s = time_s,
          .q = place(move) + way * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x),
          .dq = way * 30.0 * x * x * (1.0 - 2.0 * x + x * x) / held.move_s,
          .ddq = way * 60.0 * x * (1.0 - 3.0 * x + 2.0 * x * x) / (held.move_s * held.move_s)};
}

/// pendulum() under a controller with an encoder of 0.1 mrad, its torque with noise of 0.02 N·m.
Recording controlled(const Held& held, std::uint64_t seed, double duration_s = 40.0) {
  constexpr double kInertia = 0.3, kWeight_Nm = 9.81, kStiffness = 200.0, kDamping = 15.0,
                   kEncoder_rad = 1e-4;
  constexpr double kStep_s = 1.0 / (kRate_Hz * kStepsPerSample);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Recording recording;
  recording.name = "held";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kHeld;
  double q = placed(held, 0.0).q, dq = 0.0, push_Nm = 0.0, before_rad = q, speed_rad_s = 0.0;
  const double keeps = std::exp(-2.0 * std::numbers::pi / kRate_Hz);
  for (int i = 0; i < static_cast<int>(duration_s * kRate_Hz); ++i) {
    const Motion wanted = placed(held, i / kRate_Hz);
    const double seen_rad = kEncoder_rad * std::round(q / kEncoder_rad);
    speed_rad_s += 0.2 * ((seen_rad - before_rad) * kRate_Hz - speed_rad_s);
    before_rad = seen_rad;
    const double torque_Nm = kInertia * wanted.ddq + kWeight_Nm * std::cos(wanted.q) +
                             kStiffness * (wanted.q - seen_rad) + kDamping * (wanted.dq - speed_rad_s);
    recording.time_s.push_back(wanted.time_s);
    recording.position_rad[0].push_back(seen_rad);
    recording.torque_Nm[0].push_back(torque_Nm + 0.02 * normal(random));
    push_Nm = keeps * push_Nm + std::sqrt(1.0 - keeps * keeps) * held.push_rms_Nm * normal(random);
    for (int step = 0; step < kStepsPerSample; ++step) {
      const double free_rad_s = dq + kStep_s * (torque_Nm + push_Nm - kWeight_Nm * std::cos(q)) / kInertia;
      const double most_rad_s = held.friction_Nm * kStep_s / kInertia;
      dq = std::abs(free_rad_s) <= most_rad_s ? 0.0 : free_rad_s - std::copysign(most_rad_s, free_rad_s);
      q += kStep_s * dq;
    }
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

Diagnosis diagnosed(const Recording& recording, std::vector<double> person_Nm = {}) {
  DiagnoseOptions options;
  options.person_Nm = std::move(person_Nm);
  return diagnose(std::span(&recording, 1), {}, pendulum(), options);
}

TEST_CASE("moves of a second between rests tell dry friction, and chance stays finite") {
  const Recording recording = controlled({.move_s = 1.0, .rest_s = 1.0, .friction_Nm = 0.8}, 4);
  const Diagnosis found = diagnosed(recording);
  REQUIRE(found.verdict == Verdict::kEffectFound);
  REQUIRE(found.effects.size() == 1);
  CHECK(found.effects[0].kind == "coulomb_friction");
  CHECK(found.effects[0].parameters[0].value == doctest::Approx(0.8).epsilon(0.02));
  REQUIRE_FALSE(found.steps.empty());
  for (const SelectionStep& step : found.steps) {
    CHECK(std::all_of(step.ranking.begin(), step.ranking.end(),
                      [](const CandidateScore& score) { return std::isfinite(score.gain); }));
  }
}

TEST_CASE("where a person moves a joint that is held, her way to and fro is no friction of the joint") {
  for (const std::uint64_t seed : {61U, 64U, 67U}) {
    CAPTURE(seed);
    const Recording recording = controlled({.push_rms_Nm = 1.0}, seed);
    const Diagnosis clean = diagnosed(recording, {1.0});
    CHECK(clean.verdict == Verdict::kNothingMissing);
    REQUIRE_FALSE(clean.warnings.empty());
    CHECK(clean.warnings.front().find("joint 1 rests under a person's push") != std::string::npos);
  }
}

TEST_CASE("a pushed joint rests only where its motion has pauses, and only under a person who was declared") {
  const Recording pauses = controlled({.push_rms_Nm = 1.0}, 61);
  const Dataset pausing(std::span(&pauses, 1), {});
  CHECK(restingJoints(pausing, pendulum(), std::array{1.0}, {}) ==
        std::vector{RestingJoint{.joint = 0, .pushed = true}});
  CHECK(restingJoints(pausing, pendulum(), {}, {}).empty());
  const Recording swings = swinging(40.0, 0.5, [](const Motion&) { return 0.0; });
  CHECK(restingJoints(Dataset(std::span(&swings, 1), {}), pendulum(), std::array{1.0}, {}).empty());
}

}  // namespace
}  // namespace patella::diagnose
