#include "firmware_app/recorder/run_account.hpp"

#include <doctest/doctest.h>

#include "firmware_app/files/csv_table.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::app;

namespace {

constexpr auto kStale = safety::Fault::kEncoderStale;

/// A tick of one joint that the account is told of.
struct Told {
  Measurement measurement;
  tick::TickOutput output;
  Command sent;

  Told() {
    measurement.position_rad = JointVector::Zero(1);
    sent.torque_Nm = JointVector::Constant(1, -2.0);
    output.reference.q = output.f_s_filtered = output.d_hat_Nm = JointVector::Zero(1);
  }
  TickReport report() const {
    return {
        .sensor_latency_ns = {}, .warnings = {}, .measurement = measurement, .output = output, .sent = sent};
  }
};

}  // namespace

TEST_CASE("a cause that stays is one event, and one that returns is another") {
  RunAccount account;
  Told told;
  for (const bool present : {true, true, false, true}) {
    told.output.faults = {};
    if (present) {
      told.output.faults.add(kStale);
    }
    account.tick(told.report());
  }
  CHECK(account.statistics().ticks == 4);
  CHECK(account.statistics().fault_ticks[static_cast<std::size_t>(kStale)] == 3);
  CHECK(account.statistics().fault_events[static_cast<std::size_t>(kStale)] == 2);
}

TEST_CASE("a limit counts whichever joint it held back, and torque in both directions") {
  RunAccount account;
  Told told;
  account.tick(told.report());
  CHECK(account.statistics().limit_ticks == 0);
  CHECK(account.statistics().max_torque_Nm == 2.0);
  for (std::size_t joint = 0; joint < told.output.limits.size(); ++joint) {
    told.output.limits = {};
    told.output.limits[joint].add(safety::Limit::kTorque);
    account.tick(told.report());
    CHECK(account.statistics().limit_ticks == joint + 1);
  }
}

TEST_CASE(
    "the latency from sensor to torque counts only where both had a stamp, and from the end of init on") {
  RunAccount account;
  Told told;
  for (const auto state : {safety::State::kInit, safety::State::kReady}) {
    told.output.state = state;
    TickReport report = told.report();
    account.tick(report);
    report.sensor_latency_ns = state == safety::State::kInit ? 200'000'000 : 5000;
    account.tick(report);
  }
  CHECK(account.statistics().sensor_to_torque.count() == 1);
  CHECK(account.statistics().sensor_to_torque.maximum() == 5000);
  CHECK(account.statistics().execution.count() == 4);
}

TEST_CASE("late ticks and the periods skipped for them are summed up") {
  RunAccount account;
  account.begin();
  account.tickEnded(false, 0);
  account.tickEnded(true, 3);
  account.tickEnded(true, 0);
  account.end();
  CHECK(account.statistics().overruns == 2);
  CHECK(account.statistics().missed_periods == 3);
}

TEST_CASE("limits of each joint have eight bits of the record of their own") {
  const test::ScratchFolder folder;
  Told told;
  told.output.limits[0].add(safety::Limit::kTorque);
  told.output.limits[1].add(safety::Limit::kTorque);
  const auto bits = told.output.limits[0].bits();
  {
    RecorderOptions options;
    options.folder = folder / "run";
    options.joints = 1;
    options.lossless = true;
    Recorder recorder(options);
    RunAccount account({}, &recorder);
    account.tick(told.report());
    recorder.close();
    CHECK(recorder.writtenTicks() == 1);
  }
  const CsvTable ticks = CsvTable::load(folder / "run" / "ticks.csv", {.columns = {"limits"}});
  CHECK(ticks.column("limits")[0] == static_cast<double>(bits + 256U * bits));
}
