#include <set>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/unit/plan/planned_knee.hpp"
#include "tools/diagnose/output/plan_files.hpp"
#include "tools/diagnose/plan/motion_design.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE("joints of a motion have harmonics of one period, each once") {
  const PlanTiming timing{.duration_s = 42.0, .blend_s = 2.0, .harmonics = 6, .highest_Hz = 2.0};
  for (const int joints : {1, 2, 8}) {
    const auto all = harmonicsOf(timing, joints);
    REQUIRE(all.size() == static_cast<std::size_t>(joints));
    for (const std::vector<double>& own : all) {
      CHECK(own.size() == 6);
      CHECK(std::set<double>(own.begin(), own.end()).size() == 6);
      CHECK(own.front() >= 0.05);
      CHECK(own.back() <= 2.0);
    }
  }
  const auto two = harmonicsOf(timing, 2);
  CHECK(two[0] != two[1]);
}

TEST_CASE("a motion has as many harmonics as its period holds, up to the usual number") {
  CHECK(harmonicsOf({.duration_s = 10.0, .blend_s = 2.0, .highest_Hz = 2.0}, 2)[1].size() == 8);
  CHECK(harmonicsOf({.duration_s = 20.0, .blend_s = 2.0, .highest_Hz = 2.0}, 1)[0].size() == 18);
  CHECK(harmonicsOf({.duration_s = 60.0, .blend_s = 2.0, .highest_Hz = 2.0}, 1)[0].size() == kUsualHarmonics);
  CHECK_THROWS_WITH_AS(
      harmonicsOf({.duration_s = 3.0, .blend_s = 2.0, .highest_Hz = 1.0}, 1),
      "--duration: value 3 s with --blend 2 s, expected at least 4 s: 2 periods of 1 s after the blend, in "
      "which --harmonics 1 fit up to --highest 1 Hz",
      std::invalid_argument);
}

TEST_CASE("a period that is too short for its harmonics is refused") {
  CHECK_THROWS_WITH_AS(
      harmonicsOf({.duration_s = 6.0, .blend_s = 2.0, .harmonics = 6, .highest_Hz = 1.0}, 1),
      "--duration: value 6 s with --blend 2 s, expected at least 14 s: 2 periods of 6 s after "
      "the blend, in which --harmonics 6 fit up to --highest 1 Hz",
      std::invalid_argument);
}

TEST_CASE("a plan keeps its limits, tells more than the first motion, and is the same for the same seed") {
  const PlanRequest request = test::kneeRequest();
  const MotionPlan plan = makePlan(request);
  CHECK(plan.motion.use.kept());
  CHECK(plan.motion.use.position > 0.5);
  CHECK(plan.motion.log_determinant > plan.motion.first_log_determinant);
  REQUIRE(plan.revealed.size() == 1);
  CHECK(plan.revealed[0].smallest_size > 0.0);
  CHECK(plan.revealed[0].smallest_size < 1.0);
  CHECK(plan.others.size() == 4);
  CHECK(planReference(plan, request, {}) == planReference(makePlan(request), request, {}));
}

TEST_CASE("a chain of joints is planned for as a leg is") {
  PlanRequest request = test::kneeRequest();
  model::SerialChainParameters chain;
  for (int link = 0; link < 3; ++link) {
    chain.links.push_back({.name = std::to_string(link),
                           .origin_m = {link == 0 ? 0.0 : 0.3, 0.0, 0.0},
                           .mass_kg = 1.0,
                           .com_m = {0.15, 0.02, 0.0},
                           .inertia_kg_m2 = {0.001, 0.008, 0.008, 0.0, 0.0, 0.0}});
  }
  chain.gravity_m_s2 = {0.0, -9.81, 0.0};
  request.model.mechanism = chain;
  request.limits.joint.fill(request.limits.joint[0]);
  request.start_rad = JointVector::Constant(3, -0.9);
  request.noise.assign(3, {.noise_Nm = 0.1, .structure_Nm = 0.0});
  request.effects = {"none"};
  request.design.evaluations = 150;
  const MotionPlan plan = makePlan(request);
  CHECK(plan.motion.use.kept());
  CHECK(plan.parameters);
  CHECK(plan.revealed.empty());
  // The last link ends in its joint: it has no place for a load.
  CHECK(plan.others.size() == 14);
}

TEST_CASE("limits that no motion keeps are said to be so") {
  PlanRequest request = test::kneeRequest();
  request.limits.joint[0].torque_Nm = 0.5;
  CHECK_THROWS_AS(makePlan(request), std::runtime_error);
  request = test::kneeRequest();
  request.start_rad[0] = 0.15;
  CHECK_THROWS_AS(makePlan(request), std::invalid_argument);
}

TEST_CASE("a plan keeps the end point within its box") {
  PlanRequest request = test::kneeRequest();
  request.reach = Reach{.lowest_m = Eigen::Vector2d(-0.1, -0.1), .highest_m = Eigen::Vector2d(0.1, 0.1)};
  const MotionPlan plan = makePlan(request);
  CHECK(plan.motion.use.reach <= 1.0);
  CHECK(plan.motion.use.reach > 0.5);
  CHECK(plan.motion.use.position < 0.6);
}
