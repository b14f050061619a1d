#include "core/emg/emg_torque_map.hpp"

#include <cmath>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/support/allocation_counter.hpp"

using patella::JointVector;
using patella::emg::EmgGains;
using patella::emg::EmgTorqueMap;

TEST_CASE("extensors and flexors add with their signs, for each joint") {
  const EmgGains gains{{{10.0, -4.0, 0.0, 0.0}, {60.0, -30.0, 25.0, 0.0}}};
  const EmgTorqueMap map(2, gains);
  const auto before = patella::test::allocationCount();
  const JointVector torque = map.torque({0.5, 0.25, 0.1, 1.0});
  CHECK(patella::test::allocationCount() == before);
  REQUIRE(torque.size() == 2);
  CHECK(torque[0] == doctest::Approx(4.0));
  CHECK(torque[1] == doctest::Approx(25.0));
  // Antagonists in balance hold the joint with no torque.
  CHECK(map.torque({0.5, 1.0, 0.0, 0.0})[1] == doctest::Approx(0.0));
  CHECK(EmgTorqueMap(1, gains).torque({1.0, 0.0, 0.0, 0.0}).size() == 1);
}

TEST_CASE("gains out of range are refused by name") {
  EmgGains gains{};
  gains[1][2] = 501.0;
  CHECK_THROWS_WITH_AS(EmgTorqueMap(2, gains), "emg.gain2_Nm[3] = 501, expected -150 to 150",
                       std::invalid_argument);
  CHECK_NOTHROW(EmgTorqueMap(1, gains));
  gains[1][2] = std::nan("");
  CHECK_THROWS_AS(EmgTorqueMap(2, gains), std::invalid_argument);
  CHECK_THROWS_AS(EmgTorqueMap(patella::kMaxJoints + 1, EmgGains{}), std::invalid_argument);
}
