#include "tools/bench/plan/comparison.hpp"

#include <set>
#include <string>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::bench;

namespace {

control::ReferenceSettings sine(const Machine& machine, double amplitude_rad, double frequency_Hz) {
  control::ReferenceSettings reference;
  for (int j = 0; j < machine.nominal.joints(); ++j) {
    reference.motion[static_cast<std::size_t>(j)] = control::MultisineMotion{
        .offset_rad = machine.start_rad[j],
        .components = {{.amplitude_rad = amplitude_rad, .frequency_Hz = frequency_Hz, .phase_rad = 0.0}}};
  }
  return reference;
}

}  // namespace

TEST_CASE("machines of every kind are drawn, the same from the same seed") {
  std::set<std::string> names;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Machine machine = drawMachine(seed);
    names.insert(machine.name);
    CHECK(machine.limits.joint[0].torque_Nm > 0.0);
    CHECK(machine.limits.joint[0].torque_Nm == drawMachine(seed).limits.joint[0].torque_Nm);
  }
  CHECK(names == std::set<std::string>{"chain of 3", "knee", "leg", "rail"});
}

TEST_CASE("a machine that is driven beyond its limits is seen to be") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Machine machine = drawMachine(seed);
    const safety::JointLimits& limit = machine.limits.joint[0];
    const double half = 0.5 * (limit.q_max_rad - limit.q_min_rad);
    CHECK(follow(machine, {}, sine(machine, 0.1 * half, 0.1), 8.0).broken() == 0);
    CHECK(follow(machine, {}, sine(machine, 1.2 * half, 0.2), 8.0).range > 1.0);
    CHECK(follow(machine, {}, sine(machine, 0.5 * half, 4.0), 8.0).broken() > 0);
  }
}

TEST_CASE("a plan reveals what the best sine shows least, and keeps the limits") {
  const Machine machine = drawMachine(1000);
  const Comparison comparison = compare(machine, {.duration_s = 12.0, .evaluations = 300});
  CHECK(comparison.factor() > 2.0);
  CHECK(comparison.possible() > comparison.factor());
  CHECK(comparison.possible() < 3.0 * comparison.factor());
  CHECK(comparison.taken.broken() == 0);
  CHECK(comparison.effect.ends_with("@1"));
}
