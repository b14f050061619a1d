// A model's own motion against the recorded one.
#include "tools/diagnose/fit/simulation_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/recordings.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE("the true model moves as the machine did, another one strays, and both leave curves") {
  constexpr double kInertia_kg_m2 = 2.0;
  Recording recording = swing(20.0);
  recording.torque_timing = TorqueTiming::kSampled;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    recording.torque_Nm[0][i] =
        -kInertia_kg_m2 * std::numbers::pi * std::numbers::pi * recording.position_rad[0][i];
  }
  const Dataset data(std::array{recording}, DatasetOptions{});
  const auto simulated = [&](double inertia_kg_m2) {
    const model::ModelDescription model{
        .mechanism =
            model::RevoluteJointParameters{
                .inertia_kg_m2 = inertia_kg_m2, .moment_kg_m = 0.0, .length_m = 0.4},
        .effects = {}};
    return simulationError(data, model, 0.5);
  };
  const SimulationError right = simulated(kInertia_kg_m2);
  const SimulationError wrong = simulated(0.5 * kInertia_kg_m2);
  REQUIRE(right.rms_rad.size() == 1);
  CHECK(right.rms_rad[0] < 0.003);
  CHECK(wrong.rms_rad[0] > 20.0 * right.rms_rad[0]);

  REQUIRE(right.motion.size() == 1);
  const SimulatedMotion& motion = right.motion[0];
  const auto windows = std::count_if(motion.simulated_rad.begin(), motion.simulated_rad.end(),
                                     [](double value) { return std::isnan(value); });
  CHECK(windows >= 30);
  REQUIRE(motion.time_s.size() == motion.simulated_rad.size());
  REQUIRE(motion.time_s.size() == motion.measured_rad.size());
  CHECK(motion.time_s.size() < 35 * static_cast<std::size_t>(windows));  // thinned
  CHECK(std::is_sorted(motion.time_s.begin(), motion.time_s.end()));
  for (std::size_t i = 0; i < motion.time_s.size(); ++i) {
    if (!std::isnan(motion.simulated_rad[i])) {
      CHECK(std::abs(motion.simulated_rad[i] - motion.measured_rad[i]) < 0.02);
    }
  }
}
