// Recordings of the loop, with its own idea of which torque belongs to which sample.
#include <doctest/doctest.h>

#include "tests/unit/recordings/csv_rows.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;
using patella::test::loaded;

namespace {

constexpr const char* kHeader =
    "t_s,q1_rad,tau1_Nm,tau_cmd1_Nm,activation1,activation2,encoder_steps,latency_us";

// The loop commands 10·i after sample i; the drive reports at sample i what it held until then.
std::string tick(int i, int steps = 1, const char* latency_us = "0") {
  return fmt::format("{},{},{},{},{},0,{},{}", 0.001 * i, 0.01 * i, i == 0 ? 0 : 10 * (i - 1), 10 * i,
                     0.001 * i, steps, latency_us);
}

}  // namespace

TEST_CASE("a drive's report belongs to the step before its sample") {
  const Recording recording = loaded(csv(kHeader, 201, [](int i) { return tick(i); }));
  CHECK(recording.rows() == 200);  // what acted after the last sample is not known
  CHECK(recording.torque_timing == TorqueTiming::kHeld);
  CHECK(recording.torque_Nm[0][50] == 500.0);
  CHECK(recording.commanded_Nm[0][50] == 500.0);
  CHECK(recording.position_rad[0][50] == doctest::Approx(0.5));
  CHECK(recording.activation[0][50] == doctest::Approx(0.05));
  CHECK(recording.activation[1].empty());
}

TEST_CASE("a command that takes effect late acts that much less") {
  // A quarter of a period after its sample.
  const Recording recording = loaded(csv(kHeader, 201, [](int i) { return tick(i, 1, "250"); }));
  CHECK(recording.torque_Nm[0][50] == doctest::Approx(0.75 * 500.0 + 0.25 * 490.0));
  CHECK(recording.commanded_Nm[0][50] == doctest::Approx(recording.torque_Nm[0][50]));
}

TEST_CASE("a drive that reports what acts at the sample is taken at its word") {
  const Recording recording = loaded(csv(kHeader, 201, [](int i) { return tick(i); }),
                                     {.joints = 1, .torque_timing = TorqueTiming::kSampled});
  CHECK(recording.rows() == 201);
  CHECK(recording.torque_timing == TorqueTiming::kSampled);
  CHECK(recording.torque_Nm[0][50] == 490.0);
}

TEST_CASE("time is the encoder's: ticks without a sample go, lost samples are bridged") {
  // Tick 80 found no new sample, tick 81 found two.
  const Recording recording = loaded(csv(kHeader, 202, [](int i) {
    return tick(i == 80 ? 79 : i, i == 80 ? 0 : i == 81 ? 2 : 1);
  }));
  CHECK(recording.rate_Hz == 1000.0);
  CHECK(recording.rows() == 201);
  CHECK(recording.segments.size() == 1);
  CHECK(recording.position_rad[0][79] == doctest::Approx(0.79));
  CHECK(recording.position_rad[0][80] == doctest::Approx(0.80));
  CHECK(recording.position_rad[0][81] == doctest::Approx(0.81));
  REQUIRE(recording.warnings.size() == 1);
  CHECK(recording.warnings[0] == "1 lost samples were interpolated");
}

TEST_CASE("the true f_u of a simulated rig is read where it is asked for, and required then") {
  const std::string header = std::string(kHeader) + ",f_true1_rad_s2";
  const auto rows = csv(header.c_str(), 201, [](int i) {
    return tick(i) + "," + (i == 0 || i == 70 ? std::string() : fmt::format("{}", 0.5 * i));
  });
  CHECK(loaded(rows).unknown_rad_s2[0].empty());
  const Recording recording = loaded(rows, {.joints = 1, .truth = true});
  CHECK(recording.rows() == 200);
  CHECK(recording.unknown_rad_s2[0][0] == 0.5);  // the first that came
  CHECK(recording.unknown_rad_s2[0][69] == 34.5);
  CHECK(recording.unknown_rad_s2[0][70] == 34.5);  // none came: that of the tick before
  CHECK(recording.unknown_rad_s2[0][71] == 35.5);
  CHECK_THROWS_WITH_AS(loaded(csv(kHeader, 201, [](int i) { return tick(i); }), {.joints = 1, .truth = true}),
                       doctest::Contains("f_true1_rad_s2"), app::FileError);
}

TEST_CASE("an encoder slower than the loop sets the rate") {
  const Recording recording =
      loaded(csv(kHeader, 402, [](int i) { return tick(i - i % 2, i % 2 == 0 ? 1 : 0); }));
  CHECK(recording.rate_Hz == 500.0);
  CHECK(recording.position_rad[0][50] == doctest::Approx(1.0));
}

TEST_CASE("where no drive reports, the command is what acted") {
  const Recording recording = loaded(
      csv(kHeader, 201, [](int i) { return fmt::format("{},{},0,{},0,0,1,", 0.001 * i, 0.01 * i, 10 * i); }));
  CHECK(recording.torque_Nm[0][50] == 500.0);
  CHECK(recording.commanded_Nm[0].empty());
  REQUIRE(recording.warnings.size() == 1);
  CHECK(recording.warnings[0] == "no drive reported its torque: the commanded one is taken as applied");
}

TEST_CASE("a run folder is known by its table") {
  const test::ScratchFolder folder;
  app::writeFile(folder / "ticks.csv", csv(kHeader, 201, [](int i) { return tick(i); }));
  CHECK(loadRecording(folder.path(), {.joints = 1}).rows() == 200);
  const test::ScratchFolder empty;
  CHECK(test::messageOf<app::FileError>([&] {
          loadRecording(empty.path(), {.joints = 1});
        }).find("ticks.csv") != std::string::npos);
}

TEST_CASE("a table without motion is refused") {
  CHECK(test::refusal(csv(kHeader, 201, [](int i) { return tick(i, 0); })) ==
        "run.csv: 0 rows with an encoder sample, expected a recorded motion");
}

TEST_CASE("velocity is taken where every position has one, and no row is lost for it") {
  const std::string header = std::string(kHeader) + ",dq1_rad_s";
  const auto row = [](int i) { return tick(i) + "," + std::to_string(i); };
  CHECK(loaded(csv(header, 201, row)).velocity_rad_s[0][50] == 50.0);
  const Recording without = loaded(csv(header, 201, [&](int i) { return i == 70 ? tick(i) + "," : row(i); }));
  CHECK(without.rows() == 200);
  CHECK(without.velocity_rad_s[0].empty());
}
