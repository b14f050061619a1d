// A joint with dry friction that rests between moves: what the drive does there is friction's answer.
#include "tools/diagnose/fit/sticking.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/regression/resting.hpp"

namespace patella::diagnose {
namespace {

constexpr double kRate_Hz = 200.0, kMove_s = 1.5, kRest_s = 1.0;
constexpr double kLevel_Nm = 0.8;

/// Moves of 1.5 s to one place after the other, with a second of rest behind each.
Motion pausing(double time_s) {
  static constexpr std::array kPlaces_rad{-0.2, 0.9, 0.3, 1.1, -0.4, 0.6};
  const auto move = static_cast<std::size_t>(time_s / (kMove_s + kRest_s));
  const double from = kPlaces_rad[move % kPlaces_rad.size()],
               to = kPlaces_rad[(move + 1) % kPlaces_rad.size()];
  const double x = std::min(1.0, (time_s - static_cast<double>(move) * (kMove_s + kRest_s)) / kMove_s);
  // No jerk at both ends.
  const double way = to - from;
  return {.time_s = time_s,
          .q = from + way * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x),
          .dq = way * 30.0 * x * x * (1.0 - 2.0 * x + x * x) / kMove_s,
          .ddq = way * 60.0 * x * (1.0 - 3.0 * x + 2.0 * x * x) / (kMove_s * kMove_s)};
}

bool rests(double time_s) {
  return std::fmod(time_s, kMove_s + kRest_s) >= kMove_s;
}

/// The pendulum's torque, friction in motion, and `at_rest(number of the rest)` beside gravity at rest.
Recording recorded(double duration_s, double friction_Nm, const std::function<double(int)>& at_rest) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.03);
  const model::DynamicsModel dynamics = model::makeModel(pendulum());
  Recording recording;
  recording.name = "pausing";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 1;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < static_cast<int>(duration_s * kRate_Hz); ++i) {
    const Motion motion = pausing(i / kRate_Hz);
    const auto vector = [](double value) { return JointVector(JointVector::Constant(1, value)); };
    const double rigid_Nm =
        (dynamics.mechanism().regressor(vector(motion.q), vector(motion.dq), vector(motion.ddq)) *
         dynamics.mechanism().baseParameters())[0];
    const double held_Nm = rests(motion.time_s)
                               ? at_rest(static_cast<int>(motion.time_s / (kMove_s + kRest_s)))
                               : friction_Nm * std::tanh(motion.dq / 0.005);
    recording.time_s.push_back(motion.time_s);
    recording.position_rad[0].push_back(motion.q);
    recording.torque_Nm[0].push_back(rigid_Nm + held_Nm + noise(random));
  }
  recording.segments = {{0, recording.rows()}};
  return recording;
}

/// Anywhere below friction's level, another place at each rest.
double sticking(int rest) {
  return kLevel_Nm * std::sin(2.4 * rest + 0.3);
}

std::vector<RestingJoint> stickingIn(const Recording& recording, const std::vector<double>& person_Nm = {}) {
  return stickingJoints(Dataset(std::span(&recording, 1), {}), pendulum(), person_Nm, {});
}

TEST_CASE("a joint rests where it stays, and not where it turns round") {
  const Recording pauses = recorded(30.0, 0.0, [](int) { return 0.0; });
  const Dataset data(std::span(&pauses, 1), {});
  const Series& series = data.series().front();
  const std::vector<bool> resting = restingStates(series, {.joint = 0});
  std::size_t in_middle = 0, wrong = 0;
  for (std::size_t i = 0; i < resting.size(); ++i) {
    const double phase_s = std::fmod(series.states[i].time_s, kMove_s + kRest_s);
    const bool middle_of_rest = phase_s > kMove_s + 0.1 && phase_s < kMove_s + kRest_s - 0.1;
    const bool middle_of_move = phase_s > 0.3 && phase_s < kMove_s - 0.3;
    in_middle += middle_of_rest ? 1 : 0;
    wrong += (middle_of_rest && !resting[i]) || (middle_of_move && resting[i]) ? 1 : 0;
  }
  CHECK(in_middle > 1000);
  CHECK(wrong == 0);

  const Recording swings = swinging(30.0, 0.0, [](const Motion&) { return 0.0; });
  const Dataset turning(std::span(&swings, 1), {});
  const std::vector<bool> never = restingStates(turning.series().front(), {.joint = 0});
  CHECK(static_cast<double>(std::count(never.begin(), never.end(), true)) <
        0.01 * static_cast<double>(never.size()));
}

TEST_CASE("rows at rest are left out with their times, and columns keep what moves") {
  const Recording recording = recorded(30.0, kLevel_Nm, sticking);
  const Dataset all(std::span(&recording, 1), {});
  Dataset moving = all;
  REQUIRE(moving.leaveOutRest(std::array{RestingJoint{}}));
  CHECK(moving.rows() < 0.75 * static_cast<double>(all.rows()));
  CHECK(moving.rows() > 0.4 * static_cast<double>(all.rows()));
  CHECK(moving.time_s().size() == moving.rows());
  CHECK(moving.driveTorque().size() == moving.rows());
  CHECK(moving.blocks().size() >= 11);
  for (Eigen::Index row = 0; row < moving.rows(); ++row) {
    const double phase_s = std::fmod(moving.time_s()[row], kMove_s + kRest_s);
    CHECK_FALSE((phase_s > kMove_s + 0.1 && phase_s < kMove_s + kRest_s - 0.1));
  }
  // Both sides of the equation come up alike: a torque that is the model's leaves nothing.
  const Recording exact = recorded(30.0, 0.0, [](int) { return 0.0; });
  Dataset of_model(std::span(&exact, 1), {});
  REQUIRE(of_model.leaveOutRest(std::array{RestingJoint{}}));
  model::DynamicsModel dynamics = model::makeModel(pendulum());
  const Column left = of_model.driveTorque() - of_model.modelTorque(dynamics);
  CHECK(left.norm() < 0.02 * of_model.driveTorque().norm());

  Dataset kept = all;
  CHECK_FALSE(kept.leaveOutRest({}));
  CHECK(kept.rows() == all.rows());
}

TEST_CASE("a joint sticks where friction can answer for what is left at rest") {
  CHECK(stickingIn(recorded(60.0, kLevel_Nm, sticking)) == std::vector{RestingJoint{}});
  INFO("no friction, and nothing but gravity at rest");
  CHECK(stickingIn(recorded(60.0, 0.0, [](int) { return 0.0; })).empty());
  INFO("more at rest than the friction of the motion can hold");
  CHECK(stickingIn(recorded(60.0, 0.1, [](int rest) { return 3.0 * std::sin(2.4 * rest); })).empty());
  INFO("a person who is declared to push as much needs no friction");
  CHECK(stickingIn(recorded(60.0, kLevel_Nm, sticking), {1.0}).empty());
}

TEST_CASE(
    "dry friction of a joint that sticks is found as it is in motion, or is not missed where declared") {
  const Recording recording = recorded(60.0, kLevel_Nm, sticking);
  const Diagnosis found = diagnose(std::span(&recording, 1), {}, pendulum(), {});
  REQUIRE(found.verdict == Verdict::kEffectFound);
  REQUIRE(found.effects.size() == 1);
  CHECK(found.effects[0].kind == "coulomb_friction");
  CHECK(found.effects[0].parameters[0].ci95[0] < kLevel_Nm);
  CHECK(found.effects[0].parameters[0].ci95[1] > kLevel_Nm);
  CHECK(found.effects[0].parameters[0].value == doctest::Approx(kLevel_Nm).epsilon(0.1));
  REQUIRE_FALSE(found.warnings.empty());
  CHECK(found.warnings.front().find("joint 1 sticks when it rests") != std::string::npos);

  model::ModelDescription declared = pendulum();
  declared.effects.push_back({.kind = "coulomb_friction", .joint = 0, .parameters = {kLevel_Nm, 0.005}});
  CHECK(diagnose(std::span(&recording, 1), {}, declared, {}).verdict == Verdict::kNothingMissing);
}

}  // namespace
}  // namespace patella::diagnose
