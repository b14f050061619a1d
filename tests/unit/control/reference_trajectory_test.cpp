#include "core/control/reference_trajectory.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/allocation_counter.hpp"

using patella::JointVector;
using namespace patella::control;

namespace {

JointVector pose(double first, double second) {
  JointVector q(2);
  q << first, second;
  return q;
}

ReferenceTrajectory make(const JointMotion& first, const JointMotion& second, double blend_s = 2.0) {
  return ReferenceTrajectory(2, {.blend_s = blend_s, .motion = {first, second}});
}

}  // namespace

TEST_CASE("a reference starts at rest at the pose of activation and ends on its motion") {
  const SinusoidMotion wave{-0.9, 0.45, 0.5, 0.8};
  auto reference = make(wave, HoldMotion{0.3});
  reference.start(pose(-0.2, 1.1));

  const ReferencePoint begin = reference.at(0.0);
  CHECK(begin.q == pose(-0.2, 1.1));
  CHECK(begin.dq == pose(0.0, 0.0));
  CHECK(begin.ddq == pose(0.0, 0.0));
  CHECK(reference.at(-1.0).q == begin.q);

  for (const double t_s : {2.0, 3.7, 100.25}) {
    CAPTURE(t_s);
    const ReferencePoint point = reference.at(t_s);
    const double angle = std::numbers::pi * t_s + 0.8;
    CHECK(point.q[0] == doctest::Approx(-0.9 + 0.45 * std::sin(angle)));
    CHECK(point.dq[0] == doctest::Approx(0.45 * std::numbers::pi * std::cos(angle)));
    CHECK(point.ddq[0] == doctest::Approx(-0.45 * std::pow(std::numbers::pi, 2) * std::sin(angle)));
    CHECK(point.q[1] == doctest::Approx(0.3));
    CHECK(point.dq[1] == 0.0);
  }
}

TEST_CASE("a multisine is the sum of its sinusoids") {
  const MultisineMotion waves{.offset_rad = -0.4, .components = {{0.3, 0.2, 0.5}, {0.1, 1.3, -2.0}}};
  auto sum = make(waves, HoldMotion{});
  auto parts = make(SinusoidMotion{-0.4, 0.3, 0.2, 0.5}, SinusoidMotion{0.0, 0.1, 1.3, -2.0});
  for (const double t_s : {2.0, 4.4, 31.7}) {
    CAPTURE(t_s);
    const ReferencePoint whole = sum.at(t_s);
    const ReferencePoint part = parts.at(t_s);
    CHECK(whole.q[0] == doctest::Approx(part.q.sum()));
    CHECK(whole.dq[0] == doctest::Approx(part.dq.sum()));
    CHECK(whole.ddq[0] == doctest::Approx(part.ddq.sum()));
  }
}

TEST_CASE("Schroeder's phases keep the peak of a multisine low") {
  constexpr std::size_t kCount = 8;
  MultisineMotion aligned;
  MultisineMotion spread;
  for (std::size_t k = 0; k < kCount; ++k) {
    const SineComponent component{
        .amplitude_rad = 0.1, .frequency_Hz = 0.1 * static_cast<double>(k + 1), .phase_rad = 0.0};
    aligned.components.push_back(component);
    spread.components.push_back(component);
    spread.components.back().phase_rad = schroederPhase_rad(k, kCount);
    CHECK(std::abs(spread.components.back().phase_rad) < 2.0 * std::numbers::pi);
  }
  const auto reference = make(aligned, spread);
  JointVector peak = pose(0.0, 0.0);
  for (double t_s = 10.0; t_s < 20.0; t_s += 0.01) {
    peak = peak.cwiseMax(reference.at(t_s).q.cwiseAbs());
  }
  // In units of the rms, √(n/2) · 0.1: the crest factor, at least √2, and that of one sinusoid.
  CHECK(peak[1] < 2.0 * 0.2);
  CHECK(peak[0] > 3.0 * 0.2);
}

TEST_CASE("velocity and acceleration are the derivatives of the position, without a jump anywhere") {
  const MultisineMotion waves{.offset_rad = 0.2, .components = {{0.5, 0.7, 1.0}, {0.05, 2.1, 0.0}}};
  auto reference = make(waves, MoveMotion{-1.0, 1.5}, 1.2);
  reference.start(pose(-0.4, 0.6));
  constexpr double kStep_s = 1e-4;
  double jump = 0.0;
  for (double t_s = kStep_s; t_s < 3.0; t_s += kStep_s) {
    const ReferencePoint before = reference.at(t_s - kStep_s);
    const ReferencePoint at = reference.at(t_s);
    const ReferencePoint after = reference.at(t_s + kStep_s);
    for (int j = 0; j < 2; ++j) {
      REQUIRE(at.dq[j] == doctest::Approx((after.q[j] - before.q[j]) / (2.0 * kStep_s)).epsilon(1e-5));
      REQUIRE(at.ddq[j] == doctest::Approx((after.dq[j] - before.dq[j]) / (2.0 * kStep_s)).epsilon(1e-2));
      jump = std::max(jump, std::abs(at.ddq[j] - before.ddq[j]));
    }
  }
  CHECK(jump < 0.02);
}

TEST_CASE("a move takes its time, peaks midway at 15/8 of its mean speed, and stays") {
  auto reference = make(MoveMotion{1.0, 2.0}, HoldMotion{});
  reference.start(pose(0.0, -0.7));
  CHECK(reference.at(1.0).q[0] == doctest::Approx(0.5));
  CHECK(reference.at(1.0).dq[0] == doctest::Approx(1.875 / 2.0));
  CHECK(reference.at(2.0).q[0] == doctest::Approx(1.0));
  CHECK(reference.at(9.0).q[0] == 1.0);
  CHECK(reference.at(9.0).dq[0] == 0.0);
  CHECK(reference.at(1.3).q[1] == -0.7);
}

TEST_CASE("a new start begins from the new pose, and evaluation allocates nothing") {
  auto reference = make(MultisineMotion{.offset_rad = 0.0, .components = {{0.3, 1.0, 0.0}}}, HoldMotion{});
  const JointVector first = pose(0.1, 0.2);
  const JointVector second = pose(-0.6, 0.9);
  const auto before = patella::test::allocationCount();
  reference.start(first);
  const ReferencePoint one = reference.at(0.0);
  reference.start(second);
  const ReferencePoint two = reference.at(0.0);
  const auto after = patella::test::allocationCount();
  CHECK(after == before);
  CHECK(one.q == first);
  CHECK(two.q == second);
}

TEST_CASE("motions out of range are refused by name") {
  CHECK_THROWS_WITH_AS(make(HoldMotion{}, SinusoidMotion{0.0, 0.1, 6.0, 0.0}),
                       "reference.joint[2].frequency_Hz = 6, expected 0 to 5", std::invalid_argument);
  const auto waves = [](std::vector<SineComponent> components) {
    return make(HoldMotion{}, MultisineMotion{.offset_rad = 0.0, .components = std::move(components)});
  };
  CHECK_THROWS_WITH_AS(waves({{0.1, 1.0, 0.0}, {0.1, 6.0, 0.0}}),
                       "reference.joint[2].frequency_Hz[2] = 6, expected 0 to 5", std::invalid_argument);
  CHECK_THROWS_AS(waves({}), std::invalid_argument);
  CHECK_THROWS_AS(waves({{-0.1, 1.0, 0.0}}), std::invalid_argument);
  CHECK_THROWS_AS(waves({{0.1, 1.0, std::nan("")}}), std::invalid_argument);
  CHECK_THROWS_AS(waves({{2.0, 1.0, 0.0}, {2.0, 1.0, 0.0}}), std::invalid_argument);
  CHECK_THROWS_AS(waves(std::vector<SineComponent>(MultisineMotion::kMaxComponents + 1)),
                  std::invalid_argument);
  CHECK_THROWS_AS(make(MoveMotion{1.0, 0.0}, HoldMotion{}), std::invalid_argument);
  CHECK_THROWS_AS(make(MoveMotion{std::nan(""), 1.0}, HoldMotion{}), std::invalid_argument);
  CHECK_THROWS_AS(make(HoldMotion{7.0}, HoldMotion{}), std::invalid_argument);
  CHECK_THROWS_AS(make(HoldMotion{}, HoldMotion{}, 0.0), std::invalid_argument);
}
