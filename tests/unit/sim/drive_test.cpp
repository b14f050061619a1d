#include "sim/drive.hpp"

#include <cmath>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::sim;

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

JointVector torques(double first, double second) {
  JointVector t(2);
  t << first, second;
  return t;
}

}  // namespace

TEST_CASE("torque falls to zero 20 ms after the last valid command and comes back with the next") {
  Drive drive({}, 2, 1);
  CHECK(drive.torque().norm() == 0.0);
  CHECK_FALSE(drive.enabled());

  drive.command(torques(3.0, -2.0), true, 5 * kMillisecond);
  CHECK(drive.torque() == torques(3.0, -2.0));
  CHECK(drive.deadline_ns() == 25 * kMillisecond);
  drive.watch(25 * kMillisecond - 1);
  CHECK(drive.torque() == torques(3.0, -2.0));
  drive.watch(25 * kMillisecond);
  CHECK(drive.torque().norm() == 0.0);
  CHECK_FALSE(drive.enabled());
  CHECK(drive.fault() == DriveFault::kWatchdog);
  CHECK(drive.watchdogTrips() == 1);
  drive.watch(500 * kMillisecond);
  CHECK(drive.watchdogTrips() == 1);

  drive.command(torques(1.0, 1.0), true, 600 * kMillisecond);
  CHECK(drive.torque() == torques(1.0, 1.0));
  CHECK(drive.fault() == DriveFault::kNone);
}

TEST_CASE("a command without enable cuts the torque at once, even through a slow torque loop") {
  Drive drive({.bandwidth_Hz = 10.0}, 2, 1);
  drive.command(torques(3.0, 0.0), true, 0);
  drive.advance(1.0);
  CHECK(drive.torque()(0) == doctest::Approx(3.0));
  drive.command(torques(3.0, 0.0), false, kMillisecond);
  CHECK(drive.torque().norm() == 0.0);
  drive.advance(1.0);
  CHECK(drive.torque().norm() == 0.0);
}

TEST_CASE("torque is limited per joint on both sides") {
  Drive drive({.torque_limit_Nm = {10.0, 4.0}}, 2, 1);
  drive.command(torques(-50.0, 50.0), true, 0);
  CHECK(drive.torque() == torques(-10.0, 4.0));
}

TEST_CASE("the torque loop is first order with the asked bandwidth") {
  constexpr double kBandwidth_Hz = 50.0;
  Drive drive({.bandwidth_Hz = kBandwidth_Hz}, 1, 1);
  JointVector one(1);
  one << 1.0;
  drive.command(one, true, 0);
  CHECK(drive.torque()(0) == 0.0);
  const double time_constant_s = 1.0 / (2.0 * 3.14159265358979 * kBandwidth_Hz);
  for (int i = 0; i < 10; ++i) {
    drive.advance(0.1 * time_constant_s);
  }
  CHECK(drive.torque()(0) == doctest::Approx(1.0 - std::exp(-1.0)));
}

TEST_CASE("only the report is noisy, not the torque") {
  Drive drive({.report_noise_sd_Nm = 0.02}, 2, 1);
  drive.command(torques(1.0, 1.0), true, 0);
  double squares = 0.0;
  for (int i = 0; i < 5000; ++i) {
    squares += (drive.reportedTorque() - drive.torque()).squaredNorm();
  }
  CHECK(std::sqrt(squares / 10'000.0) == doctest::Approx(0.02).epsilon(0.05));
  CHECK(drive.torque() == torques(1.0, 1.0));
}

TEST_CASE("options out of range are refused") {
  CHECK_THROWS_AS(Drive({.watchdog_s = 0.0}, 2, 1), std::invalid_argument);
  CHECK_THROWS_AS(Drive({.torque_limit_Nm = {1.0, -1.0}}, 2, 1), std::invalid_argument);
  CHECK_THROWS_AS(Drive({.bandwidth_Hz = -1.0}, 2, 1), std::invalid_argument);
}
