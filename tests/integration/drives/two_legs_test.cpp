// Both legs in one loop: the shipped configuration, four CiA 402 drives on two buses.
#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/configuration/stability_check.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/integration/drives/drive_rig.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/sanitized.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::test;
using safety::Fault;

namespace {

constexpr std::size_t kJoints = 4;
constexpr std::uint8_t kLeft = 0;
constexpr std::uint8_t kRight = 1;

app::RunConfig twoLegs(double duration_s) {
  app::CommandLine line;
  line.config = checkout::source() / "firmware_app/config/two_legs.toml";
  line.clock = "virtual";
  line.duration_s = duration_s;
  return app::loadRunConfig(line);
}

DriveRun faultyRun(const sim::FaultEvent& event) {
  app::RunConfig config = twoLegs(2.0);
  config.faults = {event};
  config.rig.faults = config.faults;
  return runDrives(config);
}

}  // namespace

TEST_CASE("both legs move in one loop at 1 kHz: no frame lost, no heap, each drive with its commands") {
  constexpr double kRun_s = unlessSanitized(10.0, 3.0);
  const DriveRun run = runDrives(twoLegs(kRun_s));
  CHECK(run.loop.ticks == std::llround(1000.0 * kRun_s));
  CHECK(run.loop.final_state == safety::State::kActive);
  CHECK(run.loop.stops == 0);
  CHECK(run.unused_frames == 0);
  CHECK(run.bus.send_failed == 0);
  CHECK(run.rig.watchdog_trips == 0);
  REQUIRE(run.commands.size() == kJoints);
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    CAPTURE(joint);
    CHECK(run.commands[joint] == run.commands[0]);
    CHECK(run.tracking_rad(joint) < 0.05);
    CHECK_FALSE(run.enabled[joint]);
  }
  CHECK(run.loop.heap_counted == app::CountAllocations::available());
  CHECK(run.loop.heap_allocations == 0);
  CHECK(run.loop.heap_frees == 0);
}

TEST_CASE("two legs: each bus has the commands of its own leg, its SYNC and heartbeat") {
  const DriveRun run = runDrives(twoLegs(1.0), [](WatchedBus& bus) { bus.watched_tick = 805; });
  std::vector<std::uint32_t> left, right;
  for (const can::Frame& frame : run.seen) {
    (frame.bus == kLeft ? left : right).push_back(frame.id);
  }
  CHECK(left == std::vector<std::uint32_t>{0x201, 0x202, 0x080, 0x77F});
  CHECK(right == std::vector<std::uint32_t>{0x203, 0x204, 0x080, 0x77F});
}

TEST_CASE("two legs: whatever happens to one of them stops both") {
  constexpr double kAt_s = 1.5;
  const auto check = [](const sim::FaultEvent& event, Fault fault) {
    const DriveRun run = faultyRun(event);
    CAPTURE(sim::faultKindName(event.kind));
    CHECK(run.loop.final_state == safety::State::kFault);
    CHECK(run.loop.latched.has(fault));
    CHECK_FALSE(run.line_up_in_run);
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      CHECK_FALSE(run.enabled[joint]);
    }
  };
  for (const std::uint8_t bus : {kLeft, kRight}) {
    check({.kind = sim::FaultKind::kBusOff, .time_s = kAt_s, .bus = bus}, Fault::kBusOff);
    check({.kind = sim::FaultKind::kLostFrames, .time_s = kAt_s, .bus = bus}, Fault::kEncoderStale);
  }
  // Under a sanitizer one joint of each leg.
  constexpr int kNextJoint = unlessSanitized(1, static_cast<int>(kJoints) - 1);
  for (int joint = 0; joint < static_cast<int>(kJoints); joint += kNextJoint) {
    CAPTURE(joint);
    check({.kind = sim::FaultKind::kEncoderJump, .time_s = kAt_s, .channel = joint, .value = 0.5},
          Fault::kEncoderImplausible);
    check({.kind = sim::FaultKind::kDriveReportsFault, .time_s = kAt_s, .channel = joint},
          Fault::kDriveFault);
  }
}

TEST_CASE("two legs: recorded joint by joint with what the rig knows of them, and played back") {
  const std::atomic<bool> never{false};
  const ScratchFolder folder;
  app::RunConfig config = twoLegs(2.0);
  REQUIRE(app::runLoop(config, folder.path() / "run", never) == app::RunStatus::kOk);
  const auto summary =
      nlohmann::json::parse(app::readFile(folder.path() / "run/summary.json", test::kRecordingText));
  CHECK(summary["tracking_rms_rad"].size() == kJoints);
  const app::CsvTable ticks = app::CsvTable::load(folder.path() / "run/ticks.csv", {.allow_missing = true});
  for (std::size_t joint = 1; joint <= kJoints; ++joint) {
    const std::string number = std::to_string(joint);
    CAPTURE(number);
    CHECK(ticks.column("f_true" + number + "_rad_s2").size() == 2000);
    CHECK(ticks.column("tau_cmd" + number + "_Nm").size() == 2000);
  }
  config.backend = {app::BackendKind::kReplay, (folder.path() / "run/frames.log").string()};
  config.loop.max_ticks = 0;
  config.duration_s = 0.0;
  REQUIRE(app::runLoop(config, folder.path() / "again", never) == app::RunStatus::kOk);
  const auto again =
      nlohmann::json::parse(app::readFile(folder.path() / "again/summary.json", test::kRecordingText));
  CHECK(again["ticks"] == summary["ticks"]);
  CHECK(again["replay"]["frames"] == again["replay"]["frames_played"]);
}

TEST_CASE("two legs: poses drawn of four joints find the inertias that a grid of each leg's two finds") {
  const std::vector<app::JointStability> both = app::jointStability(twoLegs(1.0));
  app::CommandLine line;
  line.config = checkout::source() / "firmware_app/config/adult.toml";
  const std::vector<app::JointStability> one = app::jointStability(app::loadRunConfig(line));
  REQUIRE(both.size() == kJoints);
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    CAPTURE(joint);
    const app::JointStability& grid = one[joint % 2];
    CHECK(both[joint].lowest_inertia_kg_m2 == doctest::Approx(grid.lowest_inertia_kg_m2).epsilon(0.01));
    CHECK(both[joint].highest_inertia_kg_m2 == doctest::Approx(grid.highest_inertia_kg_m2).epsilon(0.01));
  }
}
