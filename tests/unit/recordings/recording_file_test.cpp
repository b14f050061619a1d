// Recordings with everything that goes wrong on the way to a file.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/recordings/csv_rows.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;
using patella::test::loaded;
using patella::test::refusal;

namespace {

constexpr const char* kHeader = "t_s,q1_rad,tau1_Nm";

double position(double time_s) {
  return std::sin(5.0 * time_s);
}

std::string row(double time_s, double torque_Nm) {
  return fmt::format("{:.9f},{:.12f},{}", time_s, position(time_s), torque_Nm);
}

bool warnsOf(const Recording& recording, const std::string& text) {
  return std::any_of(recording.warnings.begin(), recording.warnings.end(),
                     [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

}  // namespace

TEST_CASE("a uniform recording comes through as it is") {
  const Recording recording = loaded(csv(kHeader, 300, [](int i) { return row(i * 0.001, i); }));
  CHECK(recording.rate_Hz == 1000.0);
  CHECK(recording.rows() == 300);
  CHECK(recording.joints == 1);
  CHECK(recording.torque_timing == TorqueTiming::kHeld);
  CHECK_FALSE(recording.is_static);
  CHECK(recording.warnings.empty());
  REQUIRE(recording.segments.size() == 1);
  CHECK(recording.segments[0].first == 0);
  CHECK(recording.segments[0].end == 300);
  CHECK(recording.sha256.size() == 64);
  CHECK(recording.name.ends_with("run.csv"));
  CHECK(recording.time_s[299] == doctest::Approx(0.299));
  CHECK(recording.torque_Nm[0][123] == 123.0);
  CHECK(recording.position_rad[0][123] == doctest::Approx(position(0.123)).epsilon(1e-12));
  CHECK(recording.torque_Nm[1].empty());
  CHECK(recording.commanded_Nm[0].empty());
  CHECK(recording.activation[0].empty());
}

TEST_CASE("stamps rounded to what their file prints are those of the grid") {
  // 400 Hz in tenths of a millisecond is exact; in whole ones every other stamp is half a sample off.
  const auto rounded =
      csv(kHeader, 300, [](int i) { return fmt::format("{:.5f},{},{}", i * 0.0025 + 1e-5, i, i); });
  const Recording recording = loaded(rounded);
  CHECK(recording.rate_Hz == 400.0);
  CHECK(recording.torque_Nm[0][250] == 250.0);
}

TEST_CASE("jitter goes out: positions by the cubic, torque along lines, whether it was held or sampled") {
  const auto jittered = [](int i) { return 0.002 * i + 0.0006 * std::sin(12.9898 * i); };
  const std::string text = csv(kHeader, 500, [&](int i) { return row(jittered(i), 7.0 * jittered(i)); });
  for (const TorqueTiming timing : {TorqueTiming::kHeld, TorqueTiming::kSampled}) {
    const Recording recording = loaded(text, {.joints = 1, .torque_timing = timing});
    CHECK(recording.rate_Hz == doctest::Approx(500.0).epsilon(0.05));
    CHECK(recording.torque_timing == timing);
    double worst = 0.0;
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      worst = std::max(worst, std::abs(recording.position_rad[0][i] - position(recording.time_s[i])));
      // A held torque is not late before what was held is asked for.
      REQUIRE(recording.torque_Nm[0][i] == doctest::Approx(7.0 * recording.time_s[i]).epsilon(1e-6));
    }
    CHECK(worst < 2e-6);
  }
}

TEST_CASE("samples that only arrived late are those of the clock, in its order, lost ones counted") {
  // One in fifty rows is lost; the clock is 200 ppm fast.
  constexpr double kPeriod_s = 0.002 * (1.0 - 2e-4);
  const auto arrived = [](int i) { return kPeriod_s * i + 0.0006 * std::sin(12.9898 * i); };
  const auto torque = [](int i) { return i % 2 == 0 ? 5.0 : -5.0; };
  const std::string text = csv(kHeader, 2000, [&](int i) {
    return i % 50 == 7 ? fmt::format("{:.9f},,", arrived(i))
                       : fmt::format("{:.9f},{:.12f},{}", arrived(i), position(kPeriod_s * i), torque(i));
  });
  const Recording recording = loaded(text);
  REQUIRE(recording.rows() == 2000);
  double worst = 0.0;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    const int sample = static_cast<int>(i);
    REQUIRE(recording.torque_Nm[0][i] == torque(sample % 50 == 7 ? sample - 1 : sample));
    worst = std::max(worst, std::abs(recording.position_rad[0][i] - position(kPeriod_s * sample)));
  }
  CHECK(worst < 1e-5);
}

TEST_CASE("rows with one stamp are averaged, and counted") {
  const Recording recording = loaded(csv(kHeader, 300, [](int i) {
    return row(0.001 * (i == 100 ? 99 : i), i == 99 ? 10.0 : i == 100 ? 30.0 : 0.0);
  }));
  CHECK(recording.torque_Nm[0][99] == 20.0);
  CHECK(warnsOf(recording, "1 rows with the time stamp of the row before"));
  CHECK(warnsOf(recording, "1 lost samples were interpolated"));
}

TEST_CASE("time that runs back is refused with its line and both stamps") {
  const std::string text = csv(kHeader, 300, [](int i) { return row(0.001 * (i == 50 ? 30 : i), 0.0); });
  CHECK(refusal(text) ==
        "run.csv:52: time 0.03 s comes after 0.049 s in the row before, expected it to increase");
}

TEST_CASE("a gap divides a recording, a short one is bridged") {
  const auto text = csv(kHeader, 600, [](int i) {
    return row(0.001 * i + (i >= 200 ? 0.010 : 0.0) + (i >= 400 ? 0.5 : 0.0), 0.0);
  });
  const Recording recording = loaded(text);
  REQUIRE(recording.segments.size() == 2);
  CHECK(recording.segments[0].end == 410);
  CHECK(recording.segments[1].first == 410);
  CHECK(recording.segments[1].end == recording.rows());
  CHECK(recording.time_s[410] == doctest::Approx(0.910));
  CHECK(recording.position_rad[0][205] == doctest::Approx(position(0.205)).epsilon(1e-4));
  CHECK(warnsOf(recording, "10 lost samples were interpolated"));
  CHECK(warnsOf(recording, "1 gap of up to 0.501 s, the longest at 0.409 s"));
}

TEST_CASE("rows without a value go: at the ends silently, between as lost samples, and not too many") {
  const auto with_holes = [](int from, int to) {
    return csv(kHeader, 300, [=](int i) {
      return i < 3 || i > 295 || (i >= from && i < to) ? fmt::format("{},,", 0.001 * i) : row(0.001 * i, i);
    });
  };
  const Recording recording = loaded(with_holes(0, 0));
  CHECK(recording.rows() == 293);
  CHECK(recording.torque_Nm[0].front() == 3.0);
  const Recording holed = loaded(with_holes(120, 122));
  CHECK(holed.rows() == 293);
  CHECK(holed.segments.size() == 1);
  CHECK(warnsOf(holed, "2 rows without a value were taken as lost"));
  CHECK(warnsOf(holed, "2 lost samples were interpolated"));
  CHECK(refusal(with_holes(100, 140)) ==
        "run.csv:102: position of joint 1 has no value, as in 40 of 293 rows, expected at most 10 % of rows "
        "without");
}

TEST_CASE("what cannot be a recording is refused") {
  CHECK(refusal(csv(kHeader, 199, [](int i) { return row(0.001 * i, 0.0); })) ==
        "run.csv: 199 complete rows, expected at least 200");
  CHECK(refusal(csv("t_s,q_rad,tau1_Nm", 300, [](int i) { return row(0.001 * i, 0.0); })) ==
        "run.csv:1: there is no column 'q1_rad', did you mean 'q_rad'?; the file has 't_s', 'q_rad', "
        "'tau1_Nm'; otherwise, "
        "expected a map of the columns (--columns)");
  CHECK(refusal(csv("t_s,q1_rad,q2_rad,tau1_Nm", 300, [](int i) { return row(0.001 * i, 0.0) + ",0"; })) ==
        "run.csv:1: there is a column 'q2_rad', but the model has one joint");
  CHECK(refusal(csv(kHeader, 300, [](int i) { return i == 7 ? "0.007,abc,0" : row(0.001 * i, 0.0); })) ==
        "run.csv:9: column 'q1_rad': value 'abc', expected a number");
  CHECK(refusal("") == "run.csv:1: the file is empty, expected a header of column names");
  const std::string missing =
      test::messageOf<app::FileError>([] { loadRecording("/no/such/run.csv", {.joints = 1}); });
  CHECK(missing.find("/no/such/run.csv") != std::string::npos);
}

TEST_CASE("columns that nobody asked for may hold text") {
  const Recording recording =
      loaded(csv("label,t_s,q1_rad,tau1_Nm", 300, [](int i) { return "walk," + row(0.001 * i, 0.0); }));
  CHECK(recording.rows() == 300);
}

TEST_CASE("a command beside a measured torque is kept") {
  for (const char* name : {"tau_cmd1_Nm", "tau1_cmd_Nm"}) {
    const Recording recording = loaded(csv(std::string(kHeader) + "," + name, 300, [](int i) {
      return row(0.001 * i, i) + "," + std::to_string(2 * i);
    }));
    CHECK(recording.commanded_Nm[0][100] == 200.0);
  }
}

TEST_CASE("raw EMG becomes activation between nothing and its own largest") {
  // Half a second of rest, then a burst of 100 Hz on channel 2; channel 1 is not connected.
  const auto text = csv(std::string(kHeader) + ",emg1_mV,emg2_mV", 2000, [](int i) {
    const double burst = i >= 500 && i < 1500 ? 0.3 : 0.001;
    return row(0.001 * i, 0.0) +
           fmt::format(",0,{}", burst * std::sin(2.0 * 3.14159265 * 100.0 * 0.001 * i + 0.3));
  });
  const Recording recording = loaded(text);
  CHECK(recording.activation[0].empty());
  REQUIRE(recording.activation[1].size() == 2000);
  CHECK(recording.activation[2].empty());
  const auto& activation = recording.activation[1];
  CHECK(*std::max_element(activation.begin(), activation.end()) == 1.0);
  CHECK(activation[450] < 0.02);
  CHECK(activation[1000] > 0.85);
  CHECK(*std::min_element(activation.begin(), activation.end()) >= 0.0);
}

TEST_CASE("EMG that is slower than EMG is refused; an envelope goes by another name") {
  const auto text = [](const char* column) {
    return csv(std::string(kHeader) + "," + column, 300,
               [](int i) { return row(0.01 * i, 0.0) + "," + std::to_string(0.001 * i); });
  };
  CHECK(refusal(text("emg1_mV")) ==
        "run.csv: raw EMG at 100 Hz, expected at least 200 Hz, or its envelope as activation");
  CHECK(loaded(text("activation1")).activation[0][200] == doctest::Approx(0.2));
}
