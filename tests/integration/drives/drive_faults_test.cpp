// What two drives of others do wrong, and what the loop makes of it: the named fault, within its time, and
// both drives without torque and out.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "tests/integration/drives/drive_rig.hpp"

using namespace patella;
using namespace patella::test;
using safety::Fault;

namespace {

constexpr double kAt_s = 1.5;

/// Runs with one drive's defect, to so long after it; the second joint's drive has it.
DriveRun defective(Drives drives, sim::FaultKind kind, double at_s, double after_s,
                   double duration_s = std::numeric_limits<double>::infinity()) {
  const ScratchFolder folder;
  app::RunConfig config = driveConfiguration(drives, at_s + after_s, folder);
  config.faults = {{.kind = kind, .time_s = at_s, .duration_s = duration_s, .channel = 1}};
  config.rig.faults = config.faults;
  return runDrives(config);
}

bool stoppedBy(const DriveRun& run, Fault fault) {
  return run.loop.final_state == safety::State::kFault && run.loop.latched.has(fault);
}

/// Within its budget, and not from the beginning.
void checkStop(Drives drives, sim::FaultKind kind, Fault fault, double budget_s) {
  CAPTURE(sim::faultKindName(kind));
  CAPTURE(safety::faultName(fault));
  const DriveRun run = defective(drives, kind, kAt_s, budget_s);
  CHECK(stoppedBy(run, fault));
  CHECK(run.loop.stops == 1);
  CHECK(run.loop.state_ticks[static_cast<std::size_t>(safety::State::kActive)] >= 700);
  CHECK_FALSE(run.enabled[0]);
  const DriveRun later = defective(drives, kind, kAt_s, budget_s + 0.5);
  CHECK(later.loop.stops == 1);
  CHECK_FALSE(later.enabled[0]);
  CHECK_FALSE(later.line_up_in_run);
}

/// An ODrive's command, 32 bits of torque.
bool isZeroTorque(const can::Frame& frame) {
  return std::all_of(frame.data.begin(), frame.data.begin() + 4, [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace

TEST_CASE("a drive that falls silent is stale within 6 ms: its position is no longer heard") {
  checkStop(Drives::kMit, sim::FaultKind::kDriveSilent, Fault::kEncoderStale, 8e-3);
  checkStop(Drives::kOdrive, sim::FaultKind::kDriveSilent, Fault::kEncoderStale, 8e-3);
}

TEST_CASE("a drive that reboots is stale, and is not taken back when it returns") {
  for (const Drives drives : {Drives::kMit, Drives::kOdrive}) {
    checkStop(drives, sim::FaultKind::kDriveReboots, Fault::kEncoderStale, 8e-3);
    const DriveRun returned = defective(drives, sim::FaultKind::kDriveReboots, kAt_s, 1.0, 0.2);
    CHECK(returned.loop.final_state == safety::State::kFault);
    CHECK(returned.loop.stops == 1);
    CHECK_FALSE(returned.enabled[0]);
    CHECK_FALSE(returned.enabled[1]);
  }
}

TEST_CASE("a drive's own fault stops both") {
  checkStop(Drives::kMit, sim::FaultKind::kDriveReportsFault, Fault::kDriveFault, 4e-3);
  checkStop(Drives::kOdrive, sim::FaultKind::kDriveReportsFault, Fault::kDriveFault, 13e-3);
}

TEST_CASE("a drive that leaves by itself: by its report, or by the torque that is missing") {
  checkStop(Drives::kOdrive, sim::FaultKind::kDriveLeaves, Fault::kDriveLeft, 13e-3);
  checkStop(Drives::kMit, sim::FaultKind::kDriveLeaves, Fault::kDriveNotFollowing, 60e-3);
}

TEST_CASE("a drive that ignores enter: the time is over, or torque is missing; no torque before") {
  const DriveRun reported = defective(Drives::kOdrive, sim::FaultKind::kDriveIgnoresEnter, 0.0, 1.2);
  CHECK(stoppedBy(reported, Fault::kDriveNotEntered));
  CHECK(reported.loop.state_ticks[static_cast<std::size_t>(safety::State::kActive)] == 0);
  CHECK(reported.loop.max_torque_Nm == 0.0);
  CHECK_FALSE(reported.enabled[0]);
  const DriveRun blind = defective(Drives::kMit, sim::FaultKind::kDriveIgnoresEnter, 0.0, 0.85);
  CHECK(stoppedBy(blind, Fault::kDriveNotFollowing));
  // 42 ticks from when the command has grown beyond what may be missing.
  CHECK(blind.loop.state_ticks[static_cast<std::size_t>(safety::State::kActive)] <= 100);
  CHECK_FALSE(blind.enabled[0]);
}

TEST_CASE("torque waits until both drives are in") {
  const ScratchFolder folder;
  const DriveRun run = runDrives(driveConfiguration(Drives::kOdrive, kEnableAt_s + 0.05, folder));
  CHECK(run.loop.final_state == safety::State::kReady);
  CHECK(run.loop.max_torque_Nm == 0.0);
}

TEST_CASE(
    "one command that is lost is a failed tick: the other drive gets zero torque in it, the line is low") {
  constexpr std::uint32_t kFirst = 1U << 5U | 0x0EU;
  constexpr std::uint32_t kSecond = 2U << 5U | 0x0EU;
  constexpr int kLostAt = 1200;
  for (const std::uint32_t lost : {kFirst, kSecond}) {
    CAPTURE(lost);
    const ScratchFolder folder;
    const app::RunConfig config = driveConfiguration(Drives::kOdrive, 1.5, folder);
    const DriveRun run = runDrives(config, [lost](WatchedBus& bus) {
      bus.watched_tick = kLostAt;
      bus.keep_back = [&bus, lost](const can::Frame& frame) {
        return bus.tick == kLostAt && frame.id == lost;
      };
    });
    const std::vector<can::Frame>& seen = run.seen;
    CHECK(run.loop.stops == 0);
    CHECK(run.loop.final_state == safety::State::kActive);
    REQUIRE_FALSE(seen.empty());
    const can::Frame& last = seen.back();
    CHECK(last.id == (lost == kFirst ? kSecond : kFirst));
    CHECK(isZeroTorque(last));
    CHECK(seen.size() == (lost == kFirst ? 1U : 2U));
  }
}

TEST_CASE("a command that grows old between two drives' frames is withdrawn from the drive that has it") {
  constexpr std::uint32_t kFirst = 1U << 5U | 0x0EU;
  constexpr std::uint32_t kSecond = 2U << 5U | 0x0EU;
  constexpr int kAt = 1200;
  for (const bool too_long : {false, true}) {
    CAPTURE(too_long);
    const ScratchFolder folder;
    const app::RunConfig config = driveConfiguration(Drives::kOdrive, 1.3, folder);
    const std::int64_t span_ns =
        too_long ? 2 * std::llround(config.bus.map.encoder_timeout_s * 1e9) : 1'000'000;
    const DriveRun run = runDrives(config, [span_ns](WatchedBus& bus) {
      bus.watched_tick = kAt;
      bus.keep_back = [&bus, span_ns](const can::Frame& frame) {
        if (bus.tick == kAt && bus.seen.empty() && frame.id == kFirst) {
          bus.stall(span_ns);
        }
        return false;
      };
    });
    REQUIRE(run.seen.size() >= 2);
    CHECK(run.seen[0].id == kFirst);
    CHECK(run.seen[1].id == kSecond);
    CHECK(isZeroTorque(run.seen[0]) == false);
    CHECK(isZeroTorque(run.seen[1]) == too_long);
    CHECK(run.loop.latched.has(Fault::kCommandLate) == too_long);
    CHECK(run.line_up_in_run == !too_long);
    if (too_long) {
      REQUIRE(run.seen.size() == 3);
      CHECK(run.seen[2].id == kFirst);
      CHECK(isZeroTorque(run.seen[2]));
    }
  }
}

TEST_CASE("commands that are lost for good are a fault, and the drive that still hears is told to leave") {
  const ScratchFolder folder;
  const app::RunConfig config = driveConfiguration(Drives::kOdrive, 1.5, folder);
  const DriveRun run = runDrives(config, [](WatchedBus& bus) {
    bus.keep_back = [&bus](const can::Frame& frame) { return bus.tick >= 1200 && frame.id >> 5U == 2; };
  });
  CHECK(stoppedBy(run, Fault::kSendFailed));
  CHECK_FALSE(run.enabled[0]);
  CHECK_FALSE(run.enabled[1]);  // by its own watchdog
  CHECK(run.rig.watchdog_trips == 1);
}

TEST_CASE("frames to enter by that do not go out are lost commands, before the drive's time is over") {
  const ScratchFolder folder;
  app::RunConfig config = driveConfiguration(Drives::kOdrive, kEnableAt_s + 0.1, folder);
  for (can::CommandMap& command : config.bus.commands) {
    command.enter_period_s = 1e-3;  // in every tick
  }
  const DriveRun run = runDrives(config, [](WatchedBus& bus) {
    bus.keep_back = [](const can::Frame& frame) {
      return frame.id == (2U << 5U | 0x07U) && frame.data[0] == 8;
    };
  });
  CHECK(stoppedBy(run, Fault::kSendFailed));
  CHECK_FALSE(run.loop.latched.has(Fault::kDriveNotEntered));
}
