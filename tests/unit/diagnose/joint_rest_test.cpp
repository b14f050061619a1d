#include "tools/diagnose/regression/joint_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/verdict/material_rest.hpp"

namespace patella::diagnose {
namespace {

constexpr double kNoise_Nm = 0.05;

Diagnosis of(const std::function<double(const Motion&)>& missing, double person_Nm) {
  const Recording recording = swinging(40.0, kNoise_Nm, missing);
  DiagnoseOptions options;
  options.person_Nm = {person_Nm};
  return diagnose(std::span(&recording, 1), {}, pendulum(), options);
}

/// A person who pushes slowly, now here, now there.
double push(const Motion& motion) {
  return 2.4 * std::sin(0.7 * motion.time_s) + 1.8 * std::sin(0.31 * motion.time_s + 1.0);
}

TEST_CASE("what noise explains is not structure") {
  const JointRest rest{.torque_Nm = 2.0, .left_Nm = std::hypot(0.3, 0.1), .noise_Nm = 0.1};
  CHECK(rest.structure_Nm() == doctest::Approx(0.3));
  CHECK(rest.exceeds(0.14));
  CHECK(!rest.exceeds(0.16));
  // Little more than what sensors make is called noise, however small the torque is.
  CHECK(!JointRest{.torque_Nm = 0.1, .left_Nm = 0.15, .noise_Nm = 0.1}.exceeds(0.16));
  CHECK(JointRest{.torque_Nm = 1.0, .left_Nm = 0.05, .noise_Nm = 0.1}.structure_Nm() == 0.0);
}

TEST_CASE(
    "what is left speaks against every answer that explains less, and where nothing is asserted on its "
    "joint") {
  const auto kindsOf = [](double left_Nm, std::array<double, 2> before_Nm, int joint) {
    const std::array rests{JointRest{.torque_Nm = 5.0, .left_Nm = 0.1, .noise_Nm = 0.05},
                           JointRest{.torque_Nm = 5.0, .left_Nm = left_Nm, .noise_Nm = 0.05}};
    Diagnosis diagnosis;
    diagnosis.effects.push_back({.kind = "coulomb_friction",
                                 .joint = joint,
                                 .parameters = {},
                                 .indistinguishable_from = {},
                                 .replaces = {},
                                 .separating_motion = {}});
    judgeRest(rests, before_Nm, false, diagnosis);
    std::vector<Doubt::Kind> kinds;
    for (const Doubt& doubt : diagnosis.doubts) {
      kinds.push_back(doubt.kind);
    }
    return kinds;
  };
  constexpr double kMuch_Nm = 2.0, kSome_Nm = 0.5, kTrifle_Nm = 0.2, kMost_Nm = 5.0;
  CHECK(kindsOf(kMuch_Nm, {kMuch_Nm, kMuch_Nm}, 0) ==
        std::vector{Doubt::kJointUnexplained, Doubt::kLargeRest});
  // Less than half of what was found on the other joint, and more.
  CHECK(kindsOf(kSome_Nm, {kMuch_Nm, kSome_Nm}, 0) == std::vector{Doubt::kSomeRest});
  CHECK(kindsOf(kSome_Nm, {kTrifle_Nm, kSome_Nm}, 0) ==
        std::vector{Doubt::kJointUnexplained, Doubt::kSomeRest});
  // On the same joint: most of what was missing, and a trifle.
  CHECK(kindsOf(kMuch_Nm, {0.1, kMost_Nm}, 1) == std::vector{Doubt::kLargeRest});
  CHECK(kindsOf(kSome_Nm, {0.1, kSome_Nm + kTrifle_Nm * kTrifle_Nm}, 1) ==
        std::vector{Doubt::kJointUnexplained, Doubt::kSomeRest});
}

TEST_CASE("a joint without a drive is measured against its load") {
  Recording recording = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  const model::DynamicsModel model = model::makeModel(pendulum());
  const auto torqueOf = [&] {
    const Dataset data(std::span(&recording, 1), {});
    return jointRests(data, model.mechanism(), Column::Zero(data.rows()), std::array{0.0}).at(0).torque_Nm;
  };
  const double driven_Nm = torqueOf();
  std::fill(recording.torque_Nm[0].begin(), recording.torque_Nm[0].end(), 0.001);
  const double load_Nm = torqueOf();
  CHECK(driven_Nm > 1.0);
  CHECK(load_Nm > 1.0);
}

TEST_CASE("a slow torque of a third of the joint's is not called nothing, but for a push that was declared") {
  CHECK(of(push, 0.0).verdict != Verdict::kNothingMissing);
  const Diagnosis declared = of(push, 2.1);
  REQUIRE(declared.rests.size() == 1);
  CHECK(declared.rests[0].noise_Nm > 2.1);
  CHECK(declared.rests[0].structure_Nm < 0.2 * declared.rests[0].torque_Nm);
}

TEST_CASE("where nothing is missing, sensors make what is left") {
  const Diagnosis diagnosis = of([](const Motion&) { return 0.0; }, 0.0);
  CHECK(diagnosis.verdict == Verdict::kNothingMissing);
  REQUIRE(diagnosis.rests.size() == 1);
  CHECK(diagnosis.rests[0].structure_Nm < 0.02 * diagnosis.rests[0].torque_Nm);
}

}  // namespace
}  // namespace patella::diagnose
