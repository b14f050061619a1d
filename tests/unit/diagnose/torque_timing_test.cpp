// Torque of simulated rigs, whose drives hold it between samples.
#include "tools/diagnose/fit/torque_timing.hpp"

#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tests/unit/diagnose/swinging_arm.hpp"
#include "tools/bench/diagnose/cases.hpp"
#include "tools/diagnose/regression/dataset.hpp"

using namespace patella;
using namespace patella::bench;
using diagnose::Recording;
using diagnose::TorqueTiming;

namespace {

/// The acting torque at each sample, in place of the commanded one.
Recording asItActed(Recording recording) {
  for (std::vector<double>& torque : recording.torque_Nm) {
    for (std::size_t i = torque.size(); i-- > 1;) {
      torque[i] = 0.5 * (torque[i] + torque[i - 1]);
    }
  }
  return recording;
}

TorqueTiming timingOf(const Recording& recording, const model::ModelDescription& model) {
  return diagnose::withTorqueTiming(std::span(&recording, 1), model, {}).front().torque_timing;
}

}  // namespace

TEST_CASE("whether a torque was held shows in the motion, unless somebody says") {
  for (const char* mechanism : {"adult_leg", "light_arm"}) {
    for (const char* effect : {"viscous_friction", "coulomb_friction"}) {
      CAPTURE(mechanism);
      CAPTURE(effect);
      const Case drawn =
          drawCase(7000001, Suite::kSingle,
                   {.effect = effect, .mechanism = mechanism, .motion = "multisine", .strength = 1.0});
      Recording held = drawn.run.recording;
      held.torque_timing_assumed = true;
      CHECK(timingOf(held, drawn.nominal) == TorqueTiming::kHeld);
      Recording acted = asItActed(held);
      const auto settled = diagnose::withTorqueTiming(std::span(&acted, 1), drawn.nominal, {});
      CHECK(settled.front().torque_timing == TorqueTiming::kSampled);
      REQUIRE_FALSE(settled.front().warnings.empty());
      CHECK(settled.front().warnings.back().find("--torque") != std::string::npos);
      acted.torque_timing_assumed = false;
      CHECK(timingOf(acted, drawn.nominal) == TorqueTiming::kHeld);
    }
  }
}

TEST_CASE("a torque that acted since the sample before is told, too") {
  const Case drawn = drawCase(
      7000001, Suite::kSingle,
      {.effect = "viscous_friction", .mechanism = "adult_leg", .motion = "multisine", .strength = 1.0});
  Recording before = drawn.run.recording;
  before.torque_timing_assumed = true;
  for (std::size_t j = 0; j < static_cast<std::size_t>(before.joints); ++j) {
    std::vector<double>& torque_Nm = before.torque_Nm[j];
    torque_Nm.insert(torque_Nm.begin(), torque_Nm.front());
    torque_Nm.pop_back();
  }
  CHECK(timingOf(before, drawn.nominal) == TorqueTiming::kBefore);

  // It acts as the held one does whose samples are a row earlier.
  before.torque_timing = TorqueTiming::kBefore;
  const auto actingIn = [](const Recording& recording) {
    return diagnose::Dataset(std::span(&recording, 1), {}).driveTorque();
  };
  const Eigen::VectorXd held_Nm = actingIn(drawn.run.recording);
  CHECK((actingIn(before) - held_Nm).norm() < 1e-3 * held_Nm.norm());
}

TEST_CASE(
    "a joint that lacks something else has no vote, and joints that contradict each other get a warning") {
  const Case drawn = drawCase(
      7000001, Suite::kSingle,
      {.effect = "viscous_friction", .mechanism = "adult_leg", .motion = "multisine", .strength = 1.0});
  Recording held = drawn.run.recording;
  held.torque_timing_assumed = true;
  const Recording acted = asItActed(held);

  Recording late = acted;
  std::vector<double>& torque_Nm = late.torque_Nm[1];
  torque_Nm.insert(torque_Nm.begin(), 8, torque_Nm.front());
  torque_Nm.resize(late.rows());
  CHECK(timingOf(late, drawn.nominal) == TorqueTiming::kSampled);

  Recording mixed = acted;
  mixed.torque_Nm[0] = held.torque_Nm[0];
  const auto undecided = diagnose::withTorqueTiming(std::span(&mixed, 1), drawn.nominal, {});
  CHECK(undecided.front().torque_timing == TorqueTiming::kHeld);
  REQUIRE_FALSE(undecided.front().warnings.empty());
  CHECK(undecided.front().warnings.back().find("some joints follow their torque") != std::string::npos);
}

TEST_CASE("joints that agree on a held torque do not contradict each other") {
  for (std::uint64_t seed = 7100001; seed <= 7100006; ++seed) {
    CAPTURE(seed);
    const Case drawn =
        drawCase(seed, Suite::kNone,
                 {.effect = "", .mechanism = "chain", .motion = "multisine", .joints = 3, .strength = 0.0});
    Recording held = drawn.run.recording;
    held.torque_timing_assumed = true;
    const std::size_t warnings = held.warnings.size();
    const auto settled = diagnose::withTorqueTiming(std::span(&held, 1), drawn.nominal, {});
    CHECK(settled.front().torque_timing == TorqueTiming::kHeld);
    CHECK(settled.front().warnings.size() == warnings);
  }
}

TEST_CASE("noise of the torque does not make a sampled one look held") {
  constexpr double kNoise_Nm = 0.15;  // a tenth of the first joint's torque
  Recording noisy = diagnose::moved(diagnose::arm(), 30.0, kNoise_Nm);
  noisy.torque_timing = TorqueTiming::kHeld;
  noisy.torque_timing_assumed = true;
  CHECK(timingOf(noisy, diagnose::arm()) == TorqueTiming::kSampled);
}
