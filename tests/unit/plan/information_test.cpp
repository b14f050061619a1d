#include "tools/diagnose/plan/information.hpp"

#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/unit/plan/planned_knee.hpp"
#include "tools/diagnose/plan/best_states.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

SampledMotion swing(double amplitude_rad) {
  constexpr double kOmega = 3.0;
  SampledMotion motion{.step_s = 0.01,
                       .q = Eigen::MatrixXd(1200, 1),
                       .dq = Eigen::MatrixXd(1200, 1),
                       .ddq = Eigen::MatrixXd(1200, 1)};
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    const double angle = kOmega * motion.step_s * static_cast<double>(i);
    motion.q(i, 0) = -1.57 + amplitude_rad * std::sin(angle);
    motion.dq(i, 0) = amplitude_rad * kOmega * std::cos(angle);
    motion.ddq(i, 0) = -amplitude_rad * kOmega * kOmega * std::sin(angle);
  }
  return motion;
}

SampledMotion beginningOf(const SampledMotion& motion, Eigen::Index rows) {
  return {.step_s = motion.step_s,
          .q = motion.q.topRows(rows),
          .dq = motion.dq.topRows(rows),
          .ddq = motion.ddq.topRows(rows)};
}

Revealed revealedOf(const std::string& effect, const SampledMotion& motion, double noise_Nm,
                    double structure_Nm = 0.0) {
  PlanRequest request = test::kneeRequest();
  request.effects = {effect};
  request.noise = {{.noise_Nm = noise_Nm, .structure_Nm = structure_Nm}};
  const std::vector<Revealed> all = revealedBy(request, motion);
  REQUIRE(all.size() == 1);
  return all.front();
}

double headroomOf(const std::string& effect, const SampledMotion& motion) {
  const PlanRequest request = test::kneeRequest();
  const MotionLimits limits = usableLimits(request.limits, 1);
  Information information(request.model,
                          plannedEffects(std::vector<std::string>{effect}, request.model, limits, 12.0),
                          {.noise = request.noise, .parameters = false});
  return information.headroom(motion, limits);
}

double rms(const Eigen::MatrixXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace

TEST_CASE("the smallest viscous friction is that of its information beside the model") {
  // Velocity is across everything that the model of a knee has, so that I = Σ dq² / σ², 12 times a second.
  const SampledMotion motion = swing(0.5);
  const double rows = 12.0 * 12.0;
  const double information = rows * motion.dq.squaredNorm() / 1200.0 / 0.01;
  const double threshold = 10.0 + std::log(rows);
  const Revealed viscous = revealedOf("viscous_friction", motion, 0.1);
  CHECK(viscous.parameter == "coefficient_Nms_rad");
  CHECK(viscous.smallest_size ==
        doctest::Approx((std::sqrt(threshold) + 0.84) / std::sqrt(information)).epsilon(0.01));
}

TEST_CASE("sizes grow with the noise, and shrink with the motion") {
  CHECK(revealedOf("viscous_friction", swing(0.5), 0.2).smallest_size ==
        doctest::Approx(2.0 * revealedOf("viscous_friction", swing(0.5), 0.1).smallest_size).epsilon(1e-6));
  CHECK(revealedOf("viscous_friction", swing(1.0), 0.1).smallest_size ==
        doctest::Approx(0.5 * revealedOf("viscous_friction", swing(0.5), 0.1).smallest_size).epsilon(1e-3));
}

TEST_CASE("what nothing explains has to be outweighed") {
  const Revealed quiet = revealedOf("coulomb_friction", swing(0.5), 0.1);
  const Revealed loud = revealedOf("coulomb_friction", swing(0.5), 0.1, 1.0);
  CHECK(loud.torque_rms_Nm > 1.5);
  CHECK(loud.torque_rms_Nm > 10.0 * quiet.torque_rms_Nm);
}

TEST_CASE("a rotor on one joint shows beyond the tolerance of its inertia only") {
  // What is asked of it is more than the tolerance, which any motion leaves.
  CHECK(revealedOf("rotor_inertia", swing(0.5), 1e-4).smallest_size > 0.1 * 0.35);
}

TEST_CASE("a joint that dry friction holds tells nothing while it rests") {
  SampledMotion rests = swing(0.5);
  constexpr Eigen::Index kMoving = 600;
  const Eigen::Index at_rest = rests.q.rows() - kMoving;
  rests.q.bottomRows(at_rest).setConstant(-0.4);
  rests.dq.bottomRows(at_rest).setZero();
  rests.ddq.bottomRows(at_rest).setZero();
  const SampledMotion moves = beginningOf(rests, kMoving);
  const auto spring = [](const SampledMotion& motion, bool rubs) {
    PlanRequest request = test::kneeRequest();
    if (rubs) {
      request.model.effects = {{.kind = "coulomb_friction", .joint = 0, .parameters = {2.0, 0.01}}};
    }
    return revealedBy(request, motion).front().smallest_size;
  };
  // The rest is at a place of its own, far from where the joint moves, which tells a spring from gravity.
  CHECK(spring(rests, false) < 0.7 * spring(moves, false));
  CHECK(spring(rests, true) == doctest::Approx(spring(moves, true)).epsilon(0.05));
}

TEST_CASE("a joint that a person pushes tells nothing while it rests, nor where it creeps") {
  SampledMotion creeps = swing(0.5);
  constexpr Eigen::Index kMoving = 600;
  for (Eigen::Index i = kMoving; i < creeps.q.rows(); ++i) {
    const double since_s = creeps.step_s * static_cast<double>(i - kMoving);
    creeps.q(i, 0) = -0.4 + 0.03 * std::sin(4.0 * since_s);
    creeps.dq(i, 0) = 0.12 * std::cos(4.0 * since_s);
    creeps.ddq(i, 0) = -0.48 * std::sin(4.0 * since_s);
  }
  const SampledMotion moves = beginningOf(creeps, kMoving);
  const auto spring = [](const SampledMotion& motion, bool pushed) {
    PlanRequest request = test::kneeRequest();
    request.noise[0].pushed = pushed;
    return revealedBy(request, motion).front().smallest_size;
  };
  CHECK(spring(creeps, false) < 0.7 * spring(moves, false));
  CHECK(spring(creeps, true) == doctest::Approx(spring(moves, true)).epsilon(0.05));
}

TEST_CASE("a size whose torque nobody would miss is not promised, however little noise there is") {
  const SampledMotion motion = swing(0.5);
  const Revealed quiet = revealedOf("viscous_friction", motion, 1e-4);
  CHECK(revealedOf("viscous_friction", motion, 1e-5).smallest_size == doctest::Approx(quiet.smallest_size));
  // Gravity is most of what this knee's drive bears.
  const double gravity_Nm = 9.81 * rms(motion.q.array().sin());
  CHECK(quiet.torque_rms_Nm == doctest::Approx(0.002 * gravity_Nm).epsilon(0.1));
  CHECK(quiet.smallest_size == doctest::Approx(quiet.torque_rms_Nm / rms(motion.dq)).epsilon(1e-6));
}

TEST_CASE("no motion tells more of viscous friction than one at the highest speed") {
  const SampledMotion motion = swing(0.5);
  const double highest_rad_s = 0.75 * 4.0;
  CHECK(headroomOf("viscous_friction", motion) ==
        doctest::Approx(highest_rad_s / rms(motion.dq)).epsilon(0.03));
}

TEST_CASE("the bound does not depend on the motion that it is compared with") {
  for (const char* effect : {"linear_stiffness", "coulomb_friction", "torque_bias"}) {
    CAPTURE(effect);
    const SampledMotion little = swing(0.2), much = swing(0.6);
    const double smaller =
        revealedOf(effect, little, 0.1).smallest_size / revealedOf(effect, much, 0.1).smallest_size;
    CHECK(headroomOf(effect, much) > 1.0);
    CHECK(headroomOf(effect, little) == doctest::Approx(smaller * headroomOf(effect, much)).epsilon(0.03));
  }
}

TEST_CASE("no motion tells more of a rotor than the tolerance of the inertia leaves") {
  const double threshold = 10.0 + std::log(12.0 * 12.0);
  const double left_kg_m2 = 0.1 * 0.35 * (std::sqrt(threshold) + 0.84);
  CHECK(revealedOf("rotor_inertia", swing(0.5), 0.1).smallest_size /
            headroomOf("rotor_inertia", swing(0.5)) ==
        doctest::Approx(left_kg_m2).epsilon(0.03));
}

TEST_CASE("there is no bound for what depends on time or on the past") {
  for (const char* effect : {"actuator_lag", "presliding_hysteresis", "tremor", "thermal_drift"}) {
    CAPTURE(effect);
    CHECK(std::isnan(headroomOf(effect, swing(0.5))));
  }
}

TEST_CASE("where no state tells anything of an effect, the bound is nothing") {
  const PlanRequest request = test::kneeRequest();
  const MotionLimits limits = usableLimits(request.limits, 1);
  MotionColumns columns(request.model,
                        plannedEffects(std::vector<std::string>{"tremor"}, request.model, limits, 12.0), 0.1);
  const BestStates best = bestStates(columns, columns.main().front(), std::vector<Eigen::Index>{0},
                                     std::vector<double>{0.1}, 100.0, limits);
  CHECK(best.bound == 0.0);
}

TEST_CASE("effects are named by kind and joint") {
  PlanRequest request = test::kneeRequest();
  const MotionLimits limits = usableLimits(request.limits, 1);
  const auto named = [&](std::vector<std::string> names) {
    return plannedEffects(names, request.model, limits, 12.0);
  };
  CHECK(named({"coulomb_friction@1", "coulomb_friction"}).size() == 1);
  CHECK(named({"all"}).size() > 10);
  CHECK_THROWS_WITH_AS(named({"coulomb_friction@2"}),
                       "--effects: value 'coulomb_friction@2', expected a joint from 1 to 1 after '@'",
                       std::invalid_argument);
  CHECK_THROWS_AS(named({"coulomb_fricton"}), std::invalid_argument);
  CHECK_THROWS_AS(named({"emg_torque"}), std::invalid_argument);
  CHECK_THROWS_AS(named({"backlash@1"}), std::invalid_argument);
}
