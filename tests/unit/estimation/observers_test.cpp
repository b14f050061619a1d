// Duties of every observer, whatever its method: it finds a constant torque, follows a step and a sine,
// forgets at reset, shows what is no number, and leaves the heap alone (heap_test.cpp).
#include <cmath>
#include <limits>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/unit/estimation/observed_leg.hpp"

using namespace patella;
using namespace patella::estimation;

namespace {

const Eigen::Vector2d kBent(-1.2, -0.8);
const Eigen::Vector2d kTorque_Nm(0.8, -0.3);

/// The same sample as an encoder without velocity would give it.
ObserverInput encoderOnly(ObserverInput input, VelocityEstimator& velocity) {
  input.has_velocity = false;
  input.dq = velocity.update(input.q, input.dt_s);
  input.terms = input.model->evaluate({.q = input.q, .dq = input.dq, .torque_Nm = input.torque_Nm});
  return input;
}

}  // namespace

TEST_CASE("a constant torque is found by every observer, with and without a measured velocity") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  for (const bool has_velocity : {true, false}) {
    for (auto& [name, observer] : test::allObservers(2)) {
      CAPTURE(name);
      CAPTURE(has_velocity);
      test::ObservedLeg leg(model, kBent);
      VelocityEstimator velocity(60.0);
      velocity.reset(leg.q());
      const auto seen = [&](const ObserverInput& input) {
        return has_velocity ? input : encoderOnly(input, velocity);
      };
      observer->reset(seen(leg.sample(JointVector::Zero(2))));
      UnknownDynamics estimate;
      ObserverInput input;
      for (int n = 0; n < 3000; ++n) {
        input = seen(leg.step([](double, const JointVector&) { return JointVector(kTorque_Nm); }));
        estimate = observer->observe(input);
      }
      CHECK((estimate.d_Nm - kTorque_Nm).cwiseAbs().maxCoeff() < 0.004);
      CHECK((estimate.f_u - input.terms.inverse_inertia * kTorque_Nm).norm() <
            0.01 * (input.terms.inverse_inertia * kTorque_Nm).norm());
    }
  }
}

TEST_CASE("a step of torque arrives within its filter's time and without much overshoot") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  for (auto& [name, observer] : test::allObservers(2)) {
    CAPTURE(name);
    test::ObservedLeg leg(model, kBent);
    observer->reset(leg.sample(JointVector::Zero(2)));
    double half_s = std::numeric_limits<double>::infinity();
    double largest = 0.0;
    for (int n = 0; n < 1500; ++n) {
      const UnknownDynamics estimate = observer->observe(leg.step([](double t, const JointVector&) {
        return JointVector(t > 1.0 ? kTorque_Nm : Eigen::Vector2d(0.0, 0.0));
      }));
      const double share = estimate.d_Nm[0] / kTorque_Nm[0];
      largest = std::max(largest, share);
      if (leg.time_s() > 1.0 && share > 0.5) {
        half_s = std::min(half_s, leg.time_s() - 1.0);
      }
    }
    CHECK(half_s < 0.05);
    // A step of one joint's torque is one of both accelerations and of both components of the force, and
    // where these do not arrive at the same time, the torque swings in between.
    const bool of_torque = name.find("force") == std::string::npos && name != "super-twisting";
    CHECK(largest < (of_torque ? 1.45 : 2.3));
  }
}

TEST_CASE("a momentum observer of first order rises by 1 − 1/e in its time constant") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  MomentumObserver observer({.order = MomentumParameters::Order::kFirst, .bandwidth_Hz = everyJoint(2.0)});
  test::ObservedLeg leg(model, kBent);
  observer.reset(leg.sample(JointVector::Zero(2)));
  const double constant_s = 1.0 / (2.0 * std::numbers::pi * 2.0);
  while (leg.time_s() < constant_s - 0.5 * test::kTick_s) {
    observer.update(leg.step([](double, const JointVector&) { return JointVector(kTorque_Nm); }));
  }
  const double share = 1.0 - std::exp(-leg.time_s() / constant_s);
  CHECK(observer.residual()[0] == doctest::Approx(share * kTorque_Nm[0]).epsilon(0.01));
  CHECK(observer.residual()[1] == doctest::Approx(share * kTorque_Nm[1]).epsilon(0.01));
}

TEST_CASE("a sine of 0.5 Hz is followed in size and almost in time") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  for (auto& [name, observer] : test::allObservers(2)) {
    CAPTURE(name);
    test::ObservedLeg leg(model, kBent);
    observer->reset(leg.sample(JointVector::Zero(2)));
    double in_phase = 0.0;
    double quadrature = 0.0;
    for (int n = 0; n < 6000; ++n) {
      const double rate = std::numbers::pi;
      const UnknownDynamics estimate = observer->observe(leg.step(
          [&](double t, const JointVector&) { return JointVector(std::sin(rate * t) * kTorque_Nm); }));
      if (n >= 2000) {
        in_phase += estimate.d_Nm[0] / kTorque_Nm[0] * std::sin(rate * leg.time_s()) / 2000.0;
        quadrature += estimate.d_Nm[0] / kTorque_Nm[0] * std::cos(rate * leg.time_s()) / 2000.0;
      }
    }
    CHECK(std::hypot(in_phase, quadrature) == doctest::Approx(1.0).epsilon(0.04));
    const double delay_s = -std::atan2(quadrature, in_phase) / std::numbers::pi;
    CHECK(delay_s < 0.03);
    CHECK(delay_s > -0.005);
  }
}

TEST_CASE("reset forgets everything, in every observer") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  auto used = test::allObservers(2);
  auto fresh = test::allObservers(2);
  for (std::size_t i = 0; i < used.size(); ++i) {
    CAPTURE(used[i].name);
    test::ObservedLeg leg(model, kBent);
    const auto pushed = [](double t, const JointVector&) {
      return JointVector(std::cos(9.0 * t) * kTorque_Nm);
    };
    used[i].observer->reset(leg.sample(JointVector::Constant(2, 0.7)));
    for (int n = 0; n < 300; ++n) {
      used[i].observer->update(leg.step(pushed));
    }
    ObserverInput spoilt = leg.sample(JointVector::Zero(2));
    spoilt.dq[1] = std::nan("");
    spoilt.q[0] = std::nan("");
    used[i].observer->update(spoilt);
    const ObserverInput start = leg.sample(JointVector::Zero(2));
    used[i].observer->reset(start);
    fresh[i].observer->reset(start);
    for (int n = 0; n < 300; ++n) {
      const ObserverInput input = leg.step(pushed);
      REQUIRE(used[i].observer->update(input) == fresh[i].observer->update(input));
    }
  }
}

TEST_CASE("a sample that is no number shows in every estimate") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  for (auto& [name, observer] : test::allObservers(2)) {
    CAPTURE(name);
    test::ObservedLeg leg(model, kBent);
    observer->reset(leg.sample(JointVector::Zero(2)));
    ObserverInput spoilt = leg.sample(JointVector::Zero(2));
    spoilt.dq[0] = std::nan("");
    CHECK_FALSE(observer->update(spoilt).allFinite());
  }
}

TEST_CASE("steps of changing length do not disturb a constant estimate") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  for (auto& [name, observer] : test::allObservers(2)) {
    CAPTURE(name);
    test::ObservedLeg leg(model, kBent);
    observer->reset(leg.sample(JointVector::Zero(2)));
    double worst = 0.0;
    int missed = 0;
    for (int n = 0; n < 3000; ++n) {
      ObserverInput input = leg.step([](double, const JointVector&) { return JointVector(kTorque_Nm); });
      if (n % 7 == 3 || n % 11 == 5) {  // a frame is lost
        ++missed;
        continue;
      }
      input.dt_s = (1 + missed) * test::kTick_s;
      missed = 0;
      const UnknownDynamics estimate = observer->observe(input);
      if (n > 2000) {
        worst = std::max(worst, (estimate.d_Nm - kTorque_Nm).cwiseAbs().maxCoeff());
      }
    }
    CHECK(worst < 0.02);
  }
}

TEST_CASE("settings outside their range are refused by name and value") {
  CHECK_THROWS_WITH_AS(MomentumObserver({.bandwidth_Hz = {5.0, 0.0}}),
                       doctest::Contains("bandwidth_Hz[2] = 0"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(MomentumObserver({.damping_ratio = {-1.0, 0.7}}),
                       doctest::Contains("damping_ratio[1] = -1"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(ExtendedStateObserver({-2.0, 2.0}), doctest::Contains("bandwidth_Hz[1] = -2"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(SuperTwistingObserver({.rate_bound = {0.0, 1.0}}),
                       doctest::Contains("rate_bound_rad_s3[1] = 0"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(TerminalSlidingObserver({.p0 = 2}), doctest::Contains("p0 is 2"),
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(TerminalSlidingObserver({.boundary = 0.0}), doctest::Contains("boundary_rad_s = 0"),
                       std::invalid_argument);
  CHECK_THROWS_AS(LowPassObserver(nullptr, everyJoint(5.0), 1000.0), std::invalid_argument);
  CHECK_THROWS_WITH_AS(
      LowPassObserver(std::make_unique<ExtendedStateObserver>(everyJoint(2.0)), {5.0, 600.0}, 1000.0),
      doctest::Contains("cutoff_Hz = 600"), std::invalid_argument);
}
