#include "tools/diagnose/checks/drive_timing.hpp"

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <doctest/doctest.h>

using namespace patella::diagnose;

namespace {

constexpr double kRate_Hz = 500.0;

/// Commands of a controller: a slow motion and noise.
std::vector<double> commands(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.2);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const double t_s = static_cast<double>(i) / kRate_Hz;
    values.push_back(2.0 * std::sin(4.0 * t_s) + std::sin(23.0 * t_s) + noise(random));
  }
  return values;
}

/// The same drive integrated in steps of 10 µs.
std::vector<double> integrated(const std::vector<double>& command, double delay_s, double lag_s) {
  constexpr int kSteps = 200;
  constexpr double kStep_s = 1.0 / (kRate_Hz * kSteps);
  const auto delay = static_cast<std::ptrdiff_t>(std::lround(delay_s / kStep_s));
  std::vector<double> torque{command.front()};
  double y = command.front();
  for (std::ptrdiff_t fine = 0; torque.size() < command.size(); ++fine) {
    const std::ptrdiff_t from = fine - delay;
    const double u = from < 0 ? command.front() : command[static_cast<std::size_t>(from / kSteps)];
    y += (u - y) * (1.0 - std::exp(-kStep_s / lag_s));
    if ((fine + 1) % kSteps == 0) {
      torque.push_back(y);
    }
  }
  return torque;
}

Recording recordingOf(const std::vector<double>& commanded, const std::vector<double>& measured) {
  Recording recording;
  recording.rate_Hz = kRate_Hz;
  recording.joints = 2;
  recording.time_s.resize(commanded.size());
  recording.torque_Nm[1] = measured;
  recording.commanded_Nm[1] = commanded;
  recording.torque_Nm[0] = measured;
  recording.segments = {{.first = 0, .end = commanded.size()}};
  return recording;
}

}  // namespace

TEST_CASE("a drive's delay and lag are exact between samples too") {
  const std::vector<double> command = commands(400);
  for (const double delay_s : {0.0, 0.0007, 0.002, 0.0051}) {
    for (const double lag_s : {0.0005, 0.008}) {
      CAPTURE(delay_s);
      CAPTURE(lag_s);
      const std::vector<double> expected = integrated(command, delay_s, lag_s);
      const std::vector<double> torque = delayedAndLagged(command, kRate_Hz, delay_s, lag_s, command.front());
      double largest = 0.0;
      for (std::size_t i = 0; i < torque.size(); ++i) {
        largest = std::max(largest, std::abs(torque[i] - expected[i]));
      }
      CHECK(largest < 1e-9);
    }
  }
}

TEST_CASE("a drive without lag repeats its commands") {
  const std::vector<double> command{1.0, 2.0, 3.0, 4.0};
  CHECK(delayedAndLagged(command, kRate_Hz, 0.0, 0.0, 0.5) == command);
  CHECK(delayedAndLagged(command, kRate_Hz, 1.0 / kRate_Hz, 0.0, 0.5) == std::vector{0.5, 1.0, 2.0, 3.0});
  CHECK(delayedAndLagged(command, kRate_Hz, 0.5 / kRate_Hz, 0.0, 0.5) == std::vector{0.5, 1.0, 2.0, 3.0});
}

TEST_CASE("delay and lag of a drive are found from its torque, noise and gaps or not") {
  const std::vector<double> command = commands(4000);
  std::vector<double> measured = integrated(command, 0.003, 0.008);
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (double& value : measured) {
    value += noise(random);
  }
  Recording recording = recordingOf(command, measured);
  recording.segments = {{.first = 0, .end = 1500}, {.first = 1700, .end = 4000}};

  const std::vector<DriveTiming> timings = driveTiming(std::vector{recording});
  REQUIRE(timings.size() == 1);  // joint 1 has no commands
  CHECK(timings[0].joint == 1);
  CHECK(timings[0].delay_s == doctest::Approx(0.003).epsilon(0.05));
  CHECK(timings[0].lag_s == doctest::Approx(0.008).epsilon(0.05));
  CHECK(timings[0].relative_error_before > 0.1);
  CHECK(timings[0].relative_error_after == doctest::Approx(0.05 / 1.58).epsilon(0.05));
}

TEST_CASE("a drive that does as it is told has neither, and one that rests says nothing") {
  const std::vector<double> command = commands(500);
  const std::vector<DriveTiming> timings = driveTiming(std::vector{recordingOf(command, command)});
  REQUIRE(timings.size() == 1);
  CHECK(timings[0].delay_s == 0.0);
  CHECK(timings[0].lag_s == 0.0);
  CHECK(timings[0].relative_error_after == 0.0);

  const std::vector<double> rest(500, 0.0);
  CHECK(driveTiming(std::vector{recordingOf(rest, rest)}).empty());
  CHECK(driveTiming({}).empty());
}
