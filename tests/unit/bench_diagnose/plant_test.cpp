#include "tools/bench/diagnose/plant.hpp"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

using namespace patella::bench;

namespace {

constexpr double kPi = std::numbers::pi;
const Surroundings kNobody{};

Body leg() {
  return {.shape = Shape::kLeg,
          .mass_kg = {2.0, 0.85},
          .length_m = {0.2, 0.25},
          .com_m = {0.1, 0.125},
          .inertia_kg_m2 = {0.02, 0.0133}};
}

Body cart(double mass_kg) {
  return {.shape = Shape::kPrismatic, .mass_kg = {mass_kg, 0.0}};
}

TrueEffect effect(Kind kind, std::array<double, kMaxParameters> parameters, std::size_t joint = 0) {
  return {.kind = kind, .joint = joint, .p = parameters};
}

void run(Plant& plant, double duration_s, const patella::PerJoint& command_Nm = {}) {
  for (int tick = 0; tick < std::lround(duration_s / kTick_s); ++tick) {
    plant.advance(command_Nm);
  }
}

// Time at which the velocity of the first joint turns for the nth time, between ticks by a straight line.
double turningTime(Plant& plant, int times) {
  double before = plant.velocity()[0];
  for (int tick = 1; tick < 100'000; ++tick) {
    plant.advance({});
    const double now = plant.velocity()[0];
    if (before != 0.0 && before * now < 0.0 && --times == 0) {
      return kTick_s * (tick - 1 + before / (before - now));
    }
    before = now;
  }
  return std::nan("");
}

}  // namespace

TEST_CASE("a leg without friction keeps its energy") {
  for (const patella::PerJoint start : {patella::PerJoint{-0.6, -1.0}, patella::PerJoint{0.4, -0.3}}) {
    Plant plant(leg(), {}, kNobody, start, {0.5, -1.0});
    const double before = plant.energy();
    double worst = 0.0;
    for (int tick = 0; tick < 20'000; ++tick) {
      plant.advance({});
      worst = std::max(worst, std::abs(plant.energy() - before));
    }
    // Between highest and lowest lie 12 J.
    CHECK(worst < 2e-3);
  }
}

TEST_CASE("a pendulum takes the time of the elliptic integral, at any amplitude") {
  const Body knee{.shape = Shape::kRevolute, .inertia_kg_m2 = {0.35, 0.0}, .moment_kg_m = 1.0};
  const double slow_s = std::sqrt(0.35 / 9.81);
  for (const double amplitude : {0.01, 1.0, 2.5}) {
    Plant plant(knee, {}, kNobody, {-kPi / 2 + amplitude, 0.0});
    const double period_s = 4.0 * slow_s * std::comp_ellint_1(std::sin(amplitude / 2.0));
    CHECK(turningTime(plant, 10) == doctest::Approx(5.0 * period_s).epsilon(1e-4));
  }
}

TEST_CASE("two equal point masses swing in their two normal modes") {
  const Body masses{.shape = Shape::kLeg, .mass_kg = {1.0, 1.0}, .length_m = {0.5, 0.5}, .com_m = {0.5, 0.5}};
  for (const double sign : {1.0, -1.0}) {
    // The lower mass moves √2 times as far in angle, with the upper or against it.
    const double upper = 0.002;
    const double lower = sign * std::numbers::sqrt2 * upper;
    Plant plant(masses, {}, kNobody, {-kPi / 2 + upper, lower - upper});
    const double omega = std::sqrt(9.81 / 0.5 * (2.0 - sign * std::numbers::sqrt2));
    CHECK(turningTime(plant, 6) == doctest::Approx(6.0 * kPi / omega).epsilon(1e-4));
  }
}

TEST_CASE("a mass on a spring with a damper follows the closed form") {
  const double m = 2.0, k = 50.0, c = 3.0, x0 = 0.1;
  const std::array effects{effect(Kind::kStiffness, {k, 0.0}), effect(Kind::kViscous, {c})};
  Plant plant(cart(m), effects, kNobody, {x0, 0.0});
  const double decay = c / (2.0 * m);
  const double omega = std::sqrt(k / m - decay * decay);
  for (double time_s = 0.1; time_s < 3.0; time_s += 0.1) {
    run(plant, 0.1);
    const double exact = x0 * std::exp(-decay * time_s) *
                         (std::cos(omega * time_s) + decay / omega * std::sin(omega * time_s));
    CHECK(std::abs(plant.position()[0] - exact) < 1e-5);
  }
}

TEST_CASE("dry friction holds on a slope for as long as it can, and slides with the rest when it cannot") {
  Body slope = cart(10.0);
  slope.inclination_rad = 0.3;
  const double pull_N = 10.0 * 9.81 * std::sin(0.3);
  {
    const std::array enough{effect(Kind::kCoulomb, {1.001 * pull_N})};
    Plant plant(slope, enough, kNobody, {0.2, 0.0});
    run(plant, 5.0);
    CHECK(plant.position()[0] == 0.2);
    CHECK(plant.velocity()[0] == 0.0);
  }
  const std::array too_little{effect(Kind::kCoulomb, {0.8 * pull_N})};
  Plant plant(slope, too_little, kNobody, {0.2, 0.0});
  run(plant, 2.0);
  CHECK(plant.velocity()[0] == doctest::Approx(-2.0 * 0.2 * pull_N / 10.0).epsilon(1e-6));
}

TEST_CASE("a sliding mass stops where its energy is used up, and stays") {
  const std::array effects{effect(Kind::kCoulomb, {4.0})};
  Plant plant(cart(2.0), effects, kNobody, {0.0, 0.0}, {1.5, 0.0});
  run(plant, 2.0);
  CHECK(plant.position()[0] == doctest::Approx(2.0 * 1.5 * 1.5 / (2.0 * 4.0)).epsilon(1e-4));
  // The rest is the rounding of one step.
  CHECK(std::abs(plant.velocity()[0]) < 1e-15);
}

TEST_CASE("each joint of a leg sticks or slides for itself") {
  const std::array both{effect(Kind::kCoulomb, {6.0}, 0), effect(Kind::kCoulomb, {2.0}, 1)};
  Plant held(leg(), both, kNobody, {-0.8, -0.5});
  run(held, 3.0);
  CHECK(held.position()[0] == doctest::Approx(-0.8).epsilon(1e-12));
  CHECK(held.position()[1] == doctest::Approx(-0.5).epsilon(1e-12));

  const std::array hip{effect(Kind::kCoulomb, {20.0}, 0)};
  Plant swinging(leg(), hip, kNobody, {-0.8, -0.5});
  run(swinging, 0.3);
  CHECK(swinging.position()[0] == doctest::Approx(-0.8).epsilon(1e-12));
  CHECK(std::abs(swinging.velocity()[1]) > 1.0);
}

TEST_CASE("friction that depends on direction, speed and load has its level") {
  const auto gained = [](const TrueEffect& friction, double force_N, double velocity) {
    const std::array one{friction};
    Plant plant(cart(5.0), one, kNobody, {}, {velocity, 0.0});
    run(plant, 0.1, {force_N, 0.0});
    return (plant.velocity()[0] - velocity) * 5.0 / 0.1;
  };
  const TrueEffect asymmetric = effect(Kind::kAsymmetric, {3.0, 1.0, 0.0, 0.0});
  CHECK(gained(asymmetric, 10.0, 1.0) == doctest::Approx(7.0));
  CHECK(gained(asymmetric, -10.0, -1.0) == doctest::Approx(-9.0));
  CHECK(gained(effect(Kind::kStribeck, {2.0, 3.0, 0.05}), 10.0, 1.0) == doctest::Approx(8.0));
  CHECK(gained(effect(Kind::kStribeck, {2.0, 3.0, 0.05}), 4.9, 0.0) == 0.0);
  CHECK(gained(effect(Kind::kLoadDependent, {0.2}), 10.0, 1.0) == doctest::Approx(8.0));
  CHECK(gained(effect(Kind::kPresliding, {2.0, 4000.0, 0.0}), 10.0, 1.0) ==
        doctest::Approx(8.0).epsilon(0.01));
}

TEST_CASE("before it slides, presliding friction is a spring") {
  const std::array effects{effect(Kind::kPresliding, {10.0, 500.0, 20.0}), effect(Kind::kViscous, {50.0})};
  Plant plant(cart(2.0), effects, kNobody, {});
  run(plant, 3.0, {1.0, 0.0});
  // dF/dx = k (1 − F / level): x = −level / k ln(1 − F / level)
  CHECK(plant.position()[0] == doctest::Approx(-10.0 / 500.0 * std::log(1.0 - 0.1)).epsilon(0.01));
}

TEST_CASE("the drive lags, delays and multiplies as told") {
  const auto velocityAfter = [](const TrueEffect& drive) {
    const std::array one{drive};
    Plant plant(cart(1.0), one, kNobody, {});
    plant.advance({});
    run(plant, 0.1, {1.0, 0.0});
    return plant.velocity()[0];
  };
  CHECK(velocityAfter(effect(Kind::kGain, {0.1})) == doctest::Approx(0.11));
  CHECK(velocityAfter(effect(Kind::kDelay, {0.0125})) == doctest::Approx(0.1 - 0.0125).epsilon(1e-3));
  const double lag_s = 0.02;
  CHECK(velocityAfter(effect(Kind::kLag, {lag_s})) ==
        doctest::Approx(0.1 - lag_s * (1.0 - std::exp(-0.1 / lag_s))).epsilon(1e-3));
}

TEST_CASE("a motor behind a spring shares momentum and rings at the frequency of two masses") {
  const double m = 2.0, j = 0.5, k = 800.0;
  const std::array effects{effect(Kind::kElasticity, {k, j, 0.0})};
  Plant plant(cart(m), effects, kNobody, {});
  int crossings = 0;
  double before = 0.0, motor_before = 0.0, motor_velocity = 0.0;
  const double force_N = 3.0, duration_s = 2.0;
  for (int tick = 0; tick < std::lround(duration_s / kTick_s); ++tick) {
    plant.advance({force_N, 0.0});
    const double twist = plant.motorPosition()[0] - plant.position()[0];
    // The twist swings about what accelerates the link.
    const double swing = twist - force_N * m / (m + j) / k;
    crossings += before * swing < 0.0 ? 1 : 0;
    before = swing;
    motor_velocity = (plant.motorPosition()[0] - motor_before) / kTick_s;
    motor_before = plant.motorPosition()[0];
  }
  CHECK(m * plant.velocity()[0] + j * motor_velocity == doctest::Approx(force_N * duration_s).epsilon(2e-3));
  const double omega = std::sqrt(k * (1.0 / m + 1.0 / j));
  CHECK(std::abs(crossings - omega * duration_s / kPi) < 1.5);
}

TEST_CASE("in the gap the motor is alone") {
  const double gap = 0.02, j = 0.1, force_N = 0.5;
  const std::array effects{effect(Kind::kBacklash, {gap, 5000.0, 5.0, j})};
  Plant plant(cart(2.0), effects, kNobody, {});
  const double contact_s = std::sqrt(gap * j / force_N);  // half the gap at force / j
  run(plant, contact_s - 2e-3, {force_N, 0.0});
  CHECK(plant.position()[0] == 0.0);
  run(plant, 6e-3, {force_N, 0.0});
  CHECK(plant.velocity()[0] > 0.0);
}

TEST_CASE("a load at a segment's centre of mass is a heavier segment") {
  for (const std::size_t joint : {0U, 1U}) {
    Body heavier = leg();
    heavier.mass_kg[joint] += 0.6;
    const std::array load{effect(Kind::kPayload, {0.6, leg().com_m[joint]}, joint)};
    Plant loaded(leg(), load, kNobody, {-0.6, -1.0});
    Plant other(heavier, {}, kNobody, {-0.6, -1.0});
    run(loaded, 1.0);
    run(other, 1.0);
    CHECK(loaded.position()[0] == doctest::Approx(other.position()[0]).epsilon(1e-9));
    CHECK(loaded.position()[1] == doctest::Approx(other.position()[1]).epsilon(1e-9));
  }
}

TEST_CASE("a patient's torques come when and where they should") {
  // A held-still mass would show nothing: velocity sums the torque up.
  Surroundings around;
  around.activation[1].assign(2001, 0.0);
  std::fill(around.activation[1].begin() + 100, around.activation[1].end(), 0.5);
  const std::array muscle{effect(Kind::kEmg, {4.0, 2.0, 0.05})};
  Plant pushed(cart(2.0), muscle, around, {});
  run(pushed, 0.149);
  CHECK(pushed.velocity()[0] == 0.0);
  run(pushed, 0.101);
  CHECK(pushed.velocity()[0] == doctest::Approx(0.5 * 4.0 / 2.0 * 0.1).epsilon(0.01));

  const std::array reflex{effect(Kind::kSpasticity, {3.0, 0.4, 0.03, -1.0})};
  Plant forward(cart(2.0), reflex, kNobody, {}, {1.0, 0.0});
  run(forward, 0.2);
  CHECK(forward.velocity()[0] == 1.0);
  Plant backward(cart(2.0), reflex, kNobody, {}, {-1.0, 0.0});
  run(backward, 0.02);
  CHECK(backward.velocity()[0] == doctest::Approx(-1.0 + 3.0 * 0.6 / 2.0 * 0.02).epsilon(1e-3));
}
