// Particulars of the kinds of friction.
#include <algorithm>

#include <doctest/doctest.h>

#include "tests/unit/model/effect_fixture.hpp"

using namespace patella;
using namespace patella::model;

namespace {

EffectInput at(double q, double dq, double torque_Nm = 0.0, double time_s = 0.0) {
  return {.q = JointVector::Constant(1, q),
          .dq = JointVector::Constant(1, dq),
          .torque_Nm = JointVector::Constant(1, torque_Nm),
          .time_s = time_s};
}

double torqueOf(const char* kind, const std::vector<double>& values, const EffectInput& input) {
  const auto knee = test::makeMechanism("knee");
  return makeEffect(kind, 0, *knee, values)->torque(input)[0];
}

}  // namespace

TEST_CASE("asymmetric friction has the level and slope of its direction and none at rest") {
  const std::vector<double> values{1.5, 0.4, 0.2, 0.7, 0.01};
  CHECK(torqueOf("asymmetric_friction", values, at(0.0, 2.0)) == doctest::Approx(-1.5 - 0.2 * 2.0));
  CHECK(torqueOf("asymmetric_friction", values, at(0.0, -2.0)) == doctest::Approx(0.4 + 0.7 * 2.0));
  CHECK(torqueOf("asymmetric_friction", values, at(0.0, 0.0)) == 0.0);
  CHECK(torqueOf("asymmetric_friction", values, at(0.0, 1e-9)) == doctest::Approx(0.0).epsilon(1e-6));
}

TEST_CASE("asymmetric friction that is the same both ways is viscous and Coulomb friction") {
  for (const double dq : {-3.0, -0.004, 0.0, 0.02, 1.0}) {
    CHECK(torqueOf("asymmetric_friction", {0.8, 0.8, 0.3, 0.3, 0.01}, at(0.0, dq)) ==
          doctest::Approx(torqueOf("coulomb_friction", {0.8, 0.01}, at(0.0, dq)) +
                          torqueOf("viscous_friction", {0.3}, at(0.0, dq))));
  }
}

TEST_CASE("Stribeck friction falls from breakaway to its level") {
  const std::vector<double> values{1.0, 0.6, 0.05, 1e-4};
  CHECK(torqueOf("stribeck_friction", values, at(0.0, 1e-3)) == doctest::Approx(-1.6).epsilon(1e-3));
  CHECK(torqueOf("stribeck_friction", values, at(0.0, -0.05)) == doctest::Approx(1.0 + 0.6 * std::exp(-1.0)));
  CHECK(torqueOf("stribeck_friction", values, at(0.0, 1.0)) == doctest::Approx(-1.0));
}

TEST_CASE("load-dependent friction is a share of the drive's torque, whatever its sign") {
  for (const double load_Nm : {-20.0, 20.0}) {
    CHECK(torqueOf("load_dependent_friction", {0.1, 0.01}, at(0.0, 1.0, load_Nm)) == doctest::Approx(-2.0));
    CHECK(torqueOf("load_dependent_friction", {0.1, 0.01}, at(0.0, -1.0, load_Nm)) == doctest::Approx(2.0));
  }
  CHECK(torqueOf("load_dependent_friction", {0.1, 0.01}, at(0.0, 1.0, 0.0)) == 0.0);
}

TEST_CASE("presliding hysteresis is a spring first and its level at last") {
  const auto knee = test::makeMechanism("knee");
  const auto effect = makeEffect("presliding_hysteresis", 0, *knee, std::array{2.0, 400.0});
  effect->reset(at(0.3, 0.0));
  CHECK(effect->torque(at(0.3 + 1e-6, 0.0))[0] == doctest::Approx(-400.0 * 1e-6).epsilon(1e-3));
  CHECK(effect->torque(at(0.3 - 0.01, 0.0))[0] == doctest::Approx(2.0 * (1.0 - std::exp(-2.0))));
  CHECK(effect->torque(at(0.3 + 1.0, 0.0))[0] == doctest::Approx(-2.0));
}

TEST_CASE("presliding hysteresis depends on the way, not on the steps, and never exceeds its level") {
  const auto knee = test::makeMechanism("knee");
  std::vector<double> ends;
  for (const int steps : {7, 100, 5000}) {
    const auto effect = makeEffect("presliding_hysteresis", 0, *knee, std::array{2.0, 400.0});
    effect->reset(at(0.0, 0.0));
    double largest = 0.0;
    for (const auto& [from, to] : {std::pair{0.0, 0.02}, {0.02, -0.3}, {-0.3, -0.297}}) {
      for (int n = 1; n <= steps; ++n) {
        const EffectInput input = at(from + (to - from) * n / steps, 0.0);
        effect->advance(input, 1e-3);
        largest = std::max(largest, std::abs(effect->torque(input)[0]));
      }
    }
    ends.push_back(effect->torque(at(-0.297, 0.0))[0]);
    CHECK(largest <= 2.0);
    CHECK(largest > 1.99);
  }
  CHECK(ends[1] == doctest::Approx(ends[0]).epsilon(1e-9));
  CHECK(ends[2] == doctest::Approx(ends[0]).epsilon(1e-9));
}

TEST_CASE("presliding hysteresis runs a closed loop that takes energy out, and forgets where it began") {
  const auto knee = test::makeMechanism("knee");
  const auto effect = makeEffect("presliding_hysteresis", 0, *knee, std::array{2.0, 400.0});
  constexpr int kSteps = 2000;
  constexpr double kAmplitude_rad = 0.02;
  effect->reset(at(0.0, 0.0));
  double previous_q = 0.0;
  double previous_torque = 0.0;
  std::vector<double> work_J(4, 0.0);
  std::vector<double> first_of_cycle;
  for (int n = 1; n <= 4 * kSteps; ++n) {
    const double q = kAmplitude_rad * std::sin(2.0 * std::numbers::pi * n / kSteps);
    effect->advance(at(q, 0.0), 1e-3);
    const double torque = effect->torque(at(q, 0.0))[0];
    work_J[static_cast<std::size_t>((n - 1) / kSteps)] += 0.5 * (torque + previous_torque) * (q - previous_q);
    previous_q = q;
    previous_torque = torque;
    if (n % kSteps == 0) {
      first_of_cycle.push_back(torque);
    }
  }
  // Dahl's loop between -a and a: the branch from -a to a starts at -F, ends at F, F = level tanh(k a /
  // level), and its work less that of the branch back is 4 a level - 4 level F / k.
  const double ratio = 400.0 * kAmplitude_rad / 2.0;
  const double enclosed_J = 4.0 * kAmplitude_rad * 2.0 - 4.0 * 2.0 * 2.0 / 400.0 * std::tanh(ratio);
  CHECK(work_J[3] == doctest::Approx(-enclosed_J).epsilon(1e-4));
  CHECK(work_J[3] == doctest::Approx(work_J[2]).epsilon(1e-6));
  CHECK(first_of_cycle[3] == doctest::Approx(first_of_cycle[2]).epsilon(1e-6));
}

TEST_CASE("presliding hysteresis starts as it would be after sliding at the present velocity") {
  const auto knee = test::makeMechanism("knee");
  const auto effect = makeEffect("presliding_hysteresis", 0, *knee, std::array{2.0, 400.0});
  effect->reset(at(0.0, 1.0));
  CHECK(effect->torque(at(0.0, 1.0))[0] == doctest::Approx(-2.0));
  effect->reset(at(0.0, 0.0));
  CHECK(effect->torque(at(0.0, 0.0))[0] == 0.0);
}

TEST_CASE("thermal drift begins with nothing and ends with all of it") {
  const std::vector<double> values{0.5, 0.3, 0.2, 100.0, 0.01};
  CHECK(torqueOf("thermal_drift", values, at(0.0, 1.0, 0.0, 0.0)) == 0.0);
  CHECK(torqueOf("thermal_drift", values, at(0.0, 2.0, 0.0, 100.0)) ==
        doctest::Approx((1.0 - std::exp(-1.0)) * (0.5 - 0.3 - 0.2 * 2.0)));
  CHECK(torqueOf("thermal_drift", values, at(0.0, -2.0, 0.0, 5000.0)) == doctest::Approx(0.5 + 0.3 + 0.4));
}
