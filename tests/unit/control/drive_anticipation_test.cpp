// Looking ahead over a late drive: what is predicted is what a simulated leg does.
#include "core/control/drive_anticipation.hpp"

#include <cmath>
#include <deque>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/support/allocation_counter.hpp"

using namespace patella;
using namespace patella::control;
using model::DriveLateness;

namespace {

constexpr double kPeriod_s = 1e-3;

/// Inertia 2 kg·m² without anything else on it.
model::ModelTerms wheel() {
  model::ModelTerms terms;
  terms.inertia = JointMatrix::Constant(1, 1, 2.0);
  terms.inverse_inertia = JointMatrix::Constant(1, 1, 0.5);
  terms.bias_Nm = JointVector::Zero(1);
  terms.drive_Nm = JointVector::Zero(1);
  terms.f = JointVector::Zero(1);
  return terms;
}

JointVector one(double value) {
  return JointVector::Constant(1, value);
}

/// Command at tick k: smooth, and never the same.
double commandAt(int k) {
  return 3.0 * std::sin(0.05 * k) + std::cos(0.31 * k);
}

struct State {
  double q, dq;
};

/// After a period under a torque that is held.
State moved(State state, double torque_Nm) {
  const double ddq = 0.5 * torque_Nm;
  return {state.q + kPeriod_s * state.dq + 0.5 * kPeriod_s * kPeriod_s * ddq, state.dq + kPeriod_s * ddq};
}

}  // namespace

TEST_CASE("where no drive is late, nothing is looked ahead to") {
  DriveAnticipation none(1, {}, kPeriod_s);
  CHECK_FALSE(none.needed());
  none.commanded(one(5.0));
  CHECK(none.quickening(one(3.0))[0] == 0.0);
  JointVector q = one(2.0);
  JointVector dq = one(3.0);
  REQUIRE(none.horizons_s().size() == 1);
  none.lookAhead(wheel(), one(1.0), none.horizons_s()[0], q, dq);
  CHECK(q[0] == 2.0);
  CHECK(dq[0] == 3.0);
}

TEST_CASE("behind a delay the state ahead is the state that comes, to rounding") {
  constexpr int kDelay = 12;
  DriveAnticipation ahead(1, {DriveLateness{.delay_s = kDelay * kPeriod_s}}, kPeriod_s);
  REQUIRE(ahead.needed());
  std::deque<double> under_way(kDelay, 0.0);
  State leg{0.3, -1.0};
  for (int k = 0; k < 200; ++k) {
    JointVector q = one(leg.q);
    JointVector dq = one(leg.dq);
    ahead.lookAhead(wheel(), one(0.0), ahead.lateness_s(0), q, dq);
    State then = leg;
    for (const double torque_Nm : under_way) {
      then = moved(then, torque_Nm);
    }
    CHECK(q[0] == doctest::Approx(then.q).epsilon(1e-12));
    CHECK(dq[0] == doctest::Approx(then.dq).epsilon(1e-12));
    leg = moved(leg, under_way.front());
    under_way.pop_front();
    under_way.push_back(commandAt(k));
    ahead.commanded(one(commandAt(k)));
  }
}

TEST_CASE(
    "where one of two joints is late, both are looked ahead for: the other one's torque is taken to stay") {
  constexpr int kDelay = 10;
  constexpr double kHorizon_s = kDelay * kPeriod_s;
  DriveAnticipation ahead(2, {DriveLateness{}, DriveLateness{.delay_s = kHorizon_s}}, kPeriod_s);
  REQUIRE(ahead.horizons_s().size() == 2);
  CHECK(ahead.horizons_s()[0] == 0.0);
  CHECK(ahead.horizons_s()[1] == kHorizon_s);
  model::ModelTerms terms = wheel();
  terms.inverse_inertia = (JointMatrix(2, 2) << 0.5, -0.2, -0.2, 0.8).finished();
  terms.bias_Nm = terms.drive_Nm = JointVector::Zero(2);
  const Eigen::Vector2d command_Nm(3.0, -2.0);
  for (int k = 0; k < 2 * kDelay; ++k) {
    ahead.commanded(command_Nm);
  }
  JointVector q = Eigen::Vector2d(0.1, 0.2);
  JointVector dq = Eigen::Vector2d(-1.0, 0.5);
  const Eigen::Vector2d before_q = q;
  const Eigen::Vector2d before_dq = dq;
  ahead.lookAhead(terms, JointVector::Zero(2), kHorizon_s, q, dq);
  const Eigen::Vector2d ddq = terms.inverse_inertia * command_Nm;
  for (int joint = 0; joint < 2; ++joint) {
    CHECK(dq[joint] == doctest::Approx(before_dq[joint] + kHorizon_s * ddq[joint]).epsilon(1e-12));
    CHECK(q[joint] == doctest::Approx(before_q[joint] + kHorizon_s * before_dq[joint] +
                                      0.5 * kHorizon_s * kHorizon_s * ddq[joint])
                          .epsilon(1e-12));
  }
}

TEST_CASE("a lag is quickened: the torque follows the demand four times sooner") {
  constexpr double kLag_s = 0.02;
  DriveAnticipation ahead(1, {DriveLateness{.lag_s = kLag_s}}, kPeriod_s);
  CHECK(ahead.lateness_s(0) == doctest::Approx(kLag_s / DriveAnticipation::kQuickening));
  double arriving_Nm = 0.0;
  double time_s = 0.0;
  while (arriving_Nm < 2.0 * (1.0 - std::exp(-1.0))) {
    const JointVector demand = one(2.0);
    const JointVector command = demand + ahead.quickening(demand);
    ahead.commanded(command);
    arriving_Nm += -std::expm1(-kPeriod_s / kLag_s) * (command[0] - arriving_Nm);
    time_s += kPeriod_s;
    REQUIRE(time_s < 0.1);
  }
  CHECK(time_s >= kLag_s / DriveAnticipation::kQuickening - kPeriod_s);
  CHECK(time_s <= kLag_s / DriveAnticipation::kQuickening + kPeriod_s);
  // It settles on the demand, and asks for nothing more.
  for (int k = 0; k < 200; ++k) {
    ahead.commanded(one(2.0) + ahead.quickening(one(2.0)));
  }
  CHECK(ahead.quickening(one(2.0))[0] == doctest::Approx(0.0).epsilon(1e-9));
}

TEST_CASE("lateness out of range is refused by name") {
  CHECK_THROWS_WITH_AS(DriveAnticipation(1, {DriveLateness{.delay_s = -0.001}}, kPeriod_s),
                       "delay of joint 1, s = -0.001, expected 0 to 0.3", std::invalid_argument);
  CHECK_THROWS_WITH_AS(DriveAnticipation(2, {DriveLateness{}, DriveLateness{.lag_s = 0.31}}, kPeriod_s),
                       "lag of joint 2, s = 0.31, expected 0 to 0.3", std::invalid_argument);
}

TEST_CASE("looking ahead makes no heap operation") {
  DriveAnticipation ahead(1, {DriveLateness{.delay_s = 0.03, .lag_s = 0.02}}, kPeriod_s);
  JointVector q = one(0.0);
  JointVector dq = one(0.0);
  const std::uint64_t before = patella::test::allocationCount();
  for (int k = 0; k < 100; ++k) {
    ahead.lookAhead(wheel(), one(1.0), ahead.lateness_s(0), q, dq);
    ahead.commanded(one(1.0) + ahead.quickening(one(1.0)));
  }
  CHECK(patella::test::allocationCount() == before);
}
