// Particulars of the effects of the drive: gain, ripple, lag, delay, elasticity, backlash.
#include <algorithm>

#include <doctest/doctest.h>

#include "sim/plant.hpp"
#include "tests/unit/model/effect_fixture.hpp"

using namespace patella;
using namespace patella::model;

namespace {

EffectInput at(double torque_Nm, double time_s, bool held, double q = 0.0, double dq = 0.0) {
  return {.q = JointVector::Constant(1, q),
          .dq = JointVector::Constant(1, dq),
          .torque_Nm = JointVector::Constant(1, torque_Nm),
          .time_s = time_s,
          .torque_held = held};
}

std::unique_ptr<Effect> make(const char* kind, const std::vector<double>& values) {
  static const auto kKnee = test::makeMechanism("knee");
  return makeEffect(kind, 0, *kKnee, values);
}

JointVector scalar(double value) {
  return JointVector::Constant(1, value);
}

constexpr double kLinkInertia_kg_m2 = 0.3;

/// A link without weight, driven through one effect.
sim::Plant weightless(const char* kind, const std::vector<double>& values, double dq_rad_s = 0.0) {
  const auto mechanism = [] {
    return std::make_unique<RevoluteJoint>(RevoluteJointParameters{
        .inertia_kg_m2 = kLinkInertia_kg_m2, .moment_kg_m = 0.0, .length_m = 0.4, .gravity_m_s2 = 0.0});
  };
  auto link = mechanism();
  std::vector<std::unique_ptr<Effect>> effects;
  effects.push_back(makeEffect(kind, 0, *link, values));
  return {DynamicsModel(std::move(link), std::move(effects)),
          DynamicsModel(mechanism(), {}),
          {},
          1,
          {scalar(0.0), scalar(dq_rad_s)}};
}

}  // namespace

TEST_CASE("gain, bias and ripple are as their equations say") {
  const EffectInput input = at(8.0, 0.0, true, 0.3, 1.0);
  CHECK(make("torque_gain", {-0.1})->torque(input)[0] == doctest::Approx(-0.8));
  CHECK(make("torque_bias", {0.4})->torque(input)[0] == doctest::Approx(0.4));
  CHECK(make("torque_ripple", {0.6, 5.0, 0.2})->torque(input)[0] ==
        doctest::Approx(0.6 * std::sin(2.0 * std::numbers::pi * 5.0 * 0.3 + 0.2)));
}

TEST_CASE("a lag answers a held step exactly, whatever the rate") {
  constexpr double kTimeConstant_s = 0.02;
  for (const double dt_s : {5e-5, 1e-3, 1e-2}) {
    CAPTURE(dt_s);
    const auto lag = make("actuator_lag", {kTimeConstant_s});
    lag->reset(at(1.0, 0.0, true));
    const int steps = static_cast<int>(std::lround(0.1 / dt_s));
    for (int n = 1; n <= steps; ++n) {
      const EffectInput input = at(5.0, n * dt_s, true);
      lag->advance(input, dt_s);
      REQUIRE(5.0 + lag->torque(input)[0] ==
              doctest::Approx(5.0 - 4.0 * std::exp(-n * dt_s / kTimeConstant_s)).epsilon(1e-9));
    }
  }
}

TEST_CASE("a lag trails a sampled ramp exactly, whatever the rate") {
  constexpr double kTimeConstant_s = 0.02;
  constexpr double kSlope = 30.0;
  for (const double dt_s : {5e-5, 1e-3, 1e-2}) {
    CAPTURE(dt_s);
    const auto lag = make("actuator_lag", {kTimeConstant_s});
    lag->reset(at(0.0, 0.0, false));
    for (int n = 1; n <= static_cast<int>(std::lround(0.1 / dt_s)); ++n) {
      const double t = n * dt_s;
      const EffectInput input = at(kSlope * t, t, false);
      lag->advance(input, dt_s);
      REQUIRE(
          lag->torque(input)[0] ==
          doctest::Approx(-kSlope * kTimeConstant_s * (1.0 - std::exp(-t / kTimeConstant_s))).epsilon(1e-8));
    }
  }
}

TEST_CASE("a delay is exact on a sampled ramp, at rates from 50 µs to 10 ms and in between") {
  constexpr double kSlope = 30.0;
  for (const double delay_s : {0.0, 0.0004, 0.0123, 0.05}) {
    for (const double dt_s : {5e-5, 1.3e-4, 1e-3, 3.7e-3, 1e-2}) {
      CAPTURE(delay_s);
      CAPTURE(dt_s);
      const auto delay = make("actuator_delay", {delay_s});
      delay->reset(at(0.0, 0.0, false));
      for (int n = 1; n * dt_s < 0.3; ++n) {
        const double t = n * dt_s;
        const EffectInput input = at(kSlope * t, t, false);
        delay->advance(input, dt_s);
        const double expected = kSlope * (std::max(t - delay_s, 0.0) - t);
        REQUIRE(std::abs(delay->torque(input)[0] - expected) < 1e-9);
      }
    }
  }
}

TEST_CASE("a delayed command that is held comes as steps, late by the delay") {
  constexpr double kDelay_s = 0.0075;
  constexpr double kTick_s = 1e-3;
  constexpr double kStep_s = 1e-4;
  const auto delay = make("actuator_delay", {kDelay_s});
  delay->reset(at(0.0, 0.0, true));
  double time_s = 0.0;
  const auto command = [](double t) { return t <= 0.0 ? 0.0 : std::ceil(t / kTick_s - 1e-6); };
  for (int n = 1; n <= 500; ++n) {
    time_s = n * kStep_s;
    const EffectInput input = at(command(time_s), time_s, true);
    const double before_Nm = input.torque_Nm[0] + delay->torque(input)[0];
    delay->advance(input, kStep_s);
    const double delayed_Nm = input.torque_Nm[0] + delay->torque(input)[0];
    REQUIRE(before_Nm == doctest::Approx(delayed_Nm));
    REQUIRE(delayed_Nm == doctest::Approx(command(time_s - kDelay_s - 1e-8)));
  }
}

TEST_CASE("an elastic transmission answers steps of one length as it answers any") {
  for (const bool held : {true, false}) {
    CAPTURE(held);
    const std::vector<double> values{300.0, 0.02, 0.5};
    const auto regular = make("transmission_elasticity", values);
    const auto irregular = make("transmission_elasticity", values);
    // Too little to matter, and enough for no step to be as long as the one before.
    constexpr double kTick_s = 4e-3, kIrregular = 4e-6;
    const auto input = [held](double t) {
      return at(3.0 * std::sin(9.0 * t), t, held, 0.4 + 0.3 * std::sin(4.0 * t), 1.2 * std::cos(4.0 * t));
    };
    regular->reset(input(0.0));
    irregular->reset(input(0.0));
    double time_s = 0.0, largest_Nm = 0.0;
    for (int n = 1; n <= 500; ++n) {
      const double dt_s = kTick_s * (n % 2 == 0 ? 1.0 + kIrregular : 1.0);
      time_s += dt_s;
      regular->advance(input(n * kTick_s), kTick_s);
      irregular->advance(input(time_s), dt_s);
      const double torque_Nm = regular->torque(input(n * kTick_s))[0];
      REQUIRE(std::abs(torque_Nm - irregular->torque(input(time_s))[0]) < 1e-3);
      largest_Nm = std::max(largest_Nm, std::abs(torque_Nm));
    }
    CHECK(largest_Nm > 0.1);
  }
}

TEST_CASE("an elastic transmission resonates where two masses and a spring do") {
  for (const double stiffness : {300.0, 4000.0}) {
    CAPTURE(stiffness);
    constexpr double kRotor_kg_m2 = 0.02;
    sim::Plant plant = weightless("transmission_elasticity", {stiffness, kRotor_kg_m2, 0.0});
    plant.advance(scalar(5.0), {}, 2e-3);
    // Zero crossings of the link's acceleration, which turns around zero once the drive is off.
    constexpr double kStep_s = 1e-4;
    double last = 0.0;
    std::vector<double> rising_s;
    double amplitude_first = 0.0;
    double amplitude_last = 0.0;
    for (int n = 0; n < 10'000; ++n) {
      plant.advance(scalar(0.0), {}, kStep_s);
      const double now = plant.acceleration()[0];
      if (last < 0.0 && now >= 0.0) {
        rising_s.push_back(plant.time_s() - kStep_s * now / (now - last));
      }
      last = now;
      (n < 2000 ? amplitude_first : amplitude_last) = std::max(n < 2000   ? amplitude_first
                                                               : n < 8000 ? 0.0
                                                                          : amplitude_last,
                                                               std::abs(now));
    }
    REQUIRE(rising_s.size() > 10);
    const double frequency_Hz =
        static_cast<double>(rising_s.size() - 1) / (rising_s.back() - rising_s.front());
    const double expected_Hz =
        std::sqrt(stiffness * (1.0 / kRotor_kg_m2 + 1.0 / kLinkInertia_kg_m2)) / (2.0 * std::numbers::pi);
    CHECK(frequency_Hz == doctest::Approx(expected_Hz).epsilon(1e-3));
    // Nothing damps it: what the integration takes out in a second, some 20 to 75 periods, stays small.
    CHECK(amplitude_last > 0.7 * amplitude_first);
    CHECK(amplitude_last < 1.01 * amplitude_first);
  }
}

TEST_CASE("a stiff transmission carries the drive's torque, and its rotor's inertia counts") {
  constexpr double kRotor_kg_m2 = 0.1;
  sim::Plant elastic = weightless("transmission_elasticity", {2e4, kRotor_kg_m2, 40.0});
  sim::Plant rigid = weightless("rotor_inertia", {kRotor_kg_m2});
  for (int n = 0; n < 1000; ++n) {
    const JointVector torque = scalar(3.0 * std::sin(2.0 * std::numbers::pi * 1e-3 * n));
    elastic.advance(torque, {}, 1e-3);
    rigid.advance(torque, {}, 1e-3);
  }
  CHECK(elastic.state().q[0] == doctest::Approx(rigid.state().q[0]).epsilon(1e-3));
}

TEST_CASE("backlash transmits nothing in the gap, and everything after it") {
  constexpr double kGap_rad = 0.02;
  constexpr double kRotor_kg_m2 = 0.01;
  const auto backlash = make("backlash", {kGap_rad, 2000.0, 2.0, kRotor_kg_m2});
  backlash->reset(at(0.0, 0.0, true));
  // From the middle of the gap the motor falls freely to the contact, half the gap away.
  constexpr double kTorque_Nm = 0.5;
  constexpr double kStep_s = 1e-4;
  const double contact_s = std::sqrt(kGap_rad * kRotor_kg_m2 / kTorque_Nm);
  double first_s = 0.0;
  double transmitted_Nm = 0.0;
  for (int n = 1; n <= 5000; ++n) {
    const EffectInput input = at(kTorque_Nm, n * kStep_s, true);
    backlash->advance(input, kStep_s);
    transmitted_Nm = kTorque_Nm + backlash->torque(input)[0];
    REQUIRE(transmitted_Nm >= 0.0);
    if (first_s == 0.0 && transmitted_Nm > 0.0) {
      first_s = n * kStep_s;
    }
  }
  CHECK(first_s == doctest::Approx(contact_s).epsilon(0.02));
  CHECK(transmitted_Nm == doctest::Approx(kTorque_Nm).epsilon(1e-6));
  // The link moves within the gap: nothing is felt until the far side.
  double time_s = 0.5;
  backlash->reset(at(0.0, time_s, true));
  for (const double q : {0.002, 0.005, 0.008, -0.009}) {
    CHECK(backlash->torque(at(0.0, time_s, true, q))[0] == 0.0);
  }
  CHECK(backlash->torque(at(0.0, time_s, true, 0.011))[0] == doctest::Approx(-2000.0 * 0.001));
}

TEST_CASE("position control with integral action settles without backlash and cycles with it") {
  const auto swing = [](double gap_rad) {
    sim::Plant plant = weightless("backlash", {gap_rad, 2000.0, 2.0, 0.05});
    double integral = 0.0;
    double low = 1e9;
    double high = -1e9;
    int reversals = 0;
    double last_rate = 0.0;
    for (int n = 0; n < 12'000; ++n) {
      const double error = 0.2 - plant.state().q[0];
      integral += 1e-3 * error;
      const double torque = 40.0 * error + 60.0 * integral - 4.0 * plant.state().dq[0];
      plant.advance(scalar(torque), {}, 1e-3);
      if (n >= 8000) {
        low = std::min(low, plant.state().q[0]);
        high = std::max(high, plant.state().q[0]);
        const double rate = plant.state().dq[0];
        reversals += (rate > 0.0) != (last_rate > 0.0) ? 1 : 0;
        last_rate = rate;
      }
    }
    return std::pair{high - low, reversals};
  };
  CHECK(swing(0.0).first < 1e-5);
  const auto [range_rad, reversals] = swing(0.02);
  CHECK(range_rad > 1e-4);
  CHECK(range_rad < 0.1);
  CHECK(reversals >= 4);
}
