// Settings that would keep a monitor from watching are refused.
#include "core/safety/monitor_settings.hpp"

#include <stdexcept>

#include <doctest/doctest.h>

#include "core/bounds/bounds.hpp"
#include "tests/unit/safety/safety_fixture.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

namespace {

double above(const Bound& bound) {
  return 1.01 * bound.rehearsal_maximum;
}

}  // namespace

TEST_CASE("no monitor can be set so that it does not watch") {
  const auto refused = [](auto change) {
    MonitorSettings settings;
    change(settings);
    CHECK_THROWS_AS(requireSound(settings), std::invalid_argument);
  };
  CHECK_NOTHROW(requireSound({}));
  refused([](auto& s) { s.encoder.inconsistency_rad = above(boundOf("safety.encoder.inconsistency_rad")); });
  refused([](auto& s) { s.encoder.inconsistency_rad = kNaN; });
  refused([](auto& s) { s.encoder.frozen_rad = above(boundOf("safety.encoder.frozen_rad")); });
  refused(
      [](auto& s) { s.encoder.consistency_time_s = above(boundOf("safety.encoder.consistency_time_s")); });
  refused([](auto& s) { s.motion.unknown_torque_Nm[1] = above(boundOf("safety.motion.unknown_torque_Nm")); });
  refused([](auto& s) { s.motion.unknown_time_s = above(boundOf("safety.motion.unknown_time_s")); });
  refused([](auto& s) { s.motion.following_rad[0] = above(boundOf("safety.motion.following_rad")); });
  refused([](auto& s) { s.motion.following_time_s = above(boundOf("safety.motion.following_time_s")); });
  refused([](auto& s) { s.drive.follow_tolerance = above(boundOf("safety.drive.follow_tolerance")); });
  refused([](auto& s) { s.drive.response_s = above(boundOf("safety.drive.response_s")); });
  refused([](auto& s) { s.drive.follow_time_s = above(boundOf("safety.drive.follow_time_s")); });
  refused([](auto& s) { s.drive.over_tolerance = above(boundOf("safety.drive.over_tolerance")); });
  refused([](auto& s) { s.drive.over_time_s = above(boundOf("safety.drive.over_time_s")); });
  refused([](auto& s) { s.emg.flat_mV = -1.0; });
  refused([](auto& s) { s.emg.flat_time_s = above(boundOf("safety.emg.flat_time_s")); });
  refused([](auto& s) { s.emg.saturation_mV = above(boundOf("safety.emg.saturation_mV")); });
  refused([](auto& s) { s.emg.saturation_time_s = above(boundOf("safety.emg.saturation_time_s")); });
  refused([](auto& s) { s.emg.hum_mV = above(boundOf("safety.emg.hum_mV")); });
  refused([](auto& s) { s.emg.hum_time_s = above(boundOf("safety.emg.hum_time_s")); });
  refused([](auto& s) { s.network.disagreement_Nm[0] = above(boundOf("safety.network.disagreement_Nm")); });
  refused(
      [](auto& s) { s.network.disagreement_time_s = above(boundOf("safety.network.disagreement_time_s")); });
}
