// Signals that a faster recorder repeats until their next sample, and those that only look so.
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "tests/unit/recordings/csv_rows.hpp"
#include "tests/unit/recordings/mapped.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

constexpr int kRows = 8000;

double angle(double t_s) {
  return 0.4 * std::sin(4.0 * t_s) + 0.1 * std::sin(13.0 * t_s);
}

double torque(double t_s) {
  return 5.0 * std::cos(4.0 * t_s) + 2.0 * std::cos(9.0 * t_s);
}

Recording made(const std::function<double(int)>& position, const std::function<double(int)>& push) {
  return loadedRows(kRows, position, push);
}

/// Row in which the value of row `i` was new, each `period` rows from row `first` on.
int newAt(int i, int period, int first = 0) {
  return i < first ? first - period : i - (i - first) % period;
}

double largestError(const std::vector<double>& values, const std::vector<double>& time_s,
                    double (*truth)(double), double late_s = 0.0) {
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    largest = std::max(largest, std::abs(values[i] - truth(time_s[i] + late_s)));
  }
  return largest;
}

}  // namespace

TEST_CASE("a table with ten rows for each sample is read at the rate of its samples") {
  const Recording recording = made([](int i) { return angle(0.001 * newAt(i, 10)); },
                                   [](int i) { return torque(0.001 * newAt(i, 10)); });
  CHECK(recording.rate_Hz == doctest::Approx(100.0));
  CHECK(recording.rows() >= 798);
  CHECK(recording.torque_timing_assumed);
  CHECK(largestError(recording.position_rad[0], recording.time_s, angle) < 1e-5);
  CHECK(largestError(recording.torque_Nm[0], recording.time_s, torque) < 1e-5);
  CHECK(warnsOf(recording,
                "position of joint 1 comes at 100 Hz, torque of joint 1 comes at 100 Hz, in rows of "
                "1000 Hz: read at 100 Hz"));
}

TEST_CASE("a slow torque beside a fast position is read where it is new") {
  const Recording recording =
      made([](int i) { return angle(0.001 * i); }, [](int i) { return torque(0.001 * newAt(i, 4, 3)); });
  CHECK(recording.rate_Hz == doctest::Approx(250.0));
  CHECK(largestError(recording.position_rad[0], recording.time_s, angle) < 1e-5);
  CHECK(largestError(recording.torque_Nm[0], recording.time_s, torque) < 1e-5);
}

TEST_CASE("a fast torque beside a slow position becomes its mean until the next sample") {
  const Recording recording =
      made([](int i) { return angle(0.001 * newAt(i, 10, 6)); }, [](int i) { return torque(0.001 * i); });
  CHECK(recording.rate_Hz == doctest::Approx(100.0));
  CHECK_FALSE(recording.torque_timing_assumed);
  CHECK(recording.torque_timing == TorqueTiming::kHeld);
  CHECK(largestError(recording.position_rad[0], recording.time_s, angle) < 1e-5);
  CHECK(largestError(recording.torque_Nm[0], recording.time_s, torque, 0.0045) < 2e-3);
}

TEST_CASE("signals that are new in different rows meet between them") {
  const Recording recording = made([](int i) { return angle(0.001 * newAt(i, 8, 5)); },
                                   [](int i) { return torque(0.001 * newAt(i, 8)); });
  CHECK(recording.rate_Hz == doctest::Approx(125.0));
  CHECK(largestError(recording.position_rad[0], recording.time_s, angle) < 2e-4);
  CHECK(largestError(recording.torque_Nm[0], recording.time_s, torque) < 5e-3);
}

TEST_CASE("two clocks that drift past each other are told by their mean pace") {
  const auto sample_s = [](int i) { return std::floor(0.001 * i * 300.0) / 300.0; };
  const Recording recording =
      made([&](int i) { return angle(sample_s(i)); }, [&](int i) { return torque(sample_s(i)); });
  CHECK(recording.rate_Hz == doctest::Approx(300.0).epsilon(1e-3));
  // Stamps are those of rows, up to one of them after the sample.
  CHECK(largestError(recording.position_rad[0], recording.time_s, angle) < 0.003);
}

TEST_CASE("a joint that stands still for a while does not move in that time") {
  const auto paused_s = [](int i) { return 0.001 * (i < 3000 ? i : std::max(3000, i - 2000)); };
  const Recording recording = made([&](int i) { return angle(paused_s(newAt(i, 10))); },
                                   [](int i) { return torque(0.001 * newAt(i, 10)); });
  CHECK(recording.rate_Hz == doctest::Approx(100.0));
  REQUIRE(recording.segments.size() == 1);
  for (std::size_t i = 302; i < 498; ++i) {
    REQUIRE(recording.position_rad[0][i] == doctest::Approx(angle(3.0)).epsilon(1e-6));
  }
}

TEST_CASE("a coarse encoder, and a torque that steps slowly or at random, are left as they are") {
  SUBCASE("coarse encoder") {
    const Recording recording = made([](int i) { return std::round(angle(0.001 * i) / 0.005) * 0.005; },
                                     [](int i) { return torque(0.001 * i); });
    CHECK(recording.rate_Hz == doctest::Approx(1000.0));
  }
  SUBCASE("staircase") {
    const Recording recording =
        made([](int i) { return angle(0.001 * i); }, [](int i) { return torque(0.001 * newAt(i, 100)); });
    CHECK(recording.rate_Hz == doctest::Approx(1000.0));
    CHECK_FALSE(warnsOf(recording, "comes at"));
  }
  SUBCASE("random") {
    std::mt19937 random(7);
    std::vector<double> steps;
    for (int i = 0; i < kRows / 10 + 1; ++i) {
      steps.push_back(steps.empty() || random() % 2 == 0 ? torque(0.01 * i) : steps.back());
    }
    const Recording recording = made([](int i) { return angle(0.001 * i); },
                                     [&](int i) { return steps[static_cast<std::size_t>(i / 10)]; });
    CHECK(recording.rate_Hz == doctest::Approx(1000.0));
  }
}

TEST_CASE("a stretch that is too short for a sample of its own is left out, and so is a recording") {
  const auto paused = [](int rows) {
    return csv(kOneJoint, rows, [](int i) {
      const double gap_s = i < 7 ? 0.0 : 1.0;
      return fmt::format("{:.3f},{:.9f},{:.6f}", 0.001 * i + gap_s, angle(0.001 * newAt(i, 10)),
                         torque(0.001 * newAt(i, 10)));
    });
  };
  const Recording recording = loaded(paused(kRows));
  CHECK(recording.rate_Hz == doctest::Approx(100.0));
  for (const Segment& segment : recording.segments) {
    CHECK(segment.first < segment.end);
  }
  CHECK(refusal(paused(1500)).find("complete rows, expected at least 200") != std::string::npos);
}
