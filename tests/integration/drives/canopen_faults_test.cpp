// What CiA 402 drives do wrong, and what the loop makes of it: before the first tick a refusal in words, in a
// run the named fault, with code and text in the events.
#include <atomic>
#include <limits>

#include <doctest/doctest.h>

#include "drivers/canopen/sdo_client.hpp"
#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/integration/drives/drive_rig.hpp"

using namespace patella;
using namespace patella::test;
using safety::Fault;
using sim::FaultKind;

namespace {

constexpr double kAt_s = 1.5;
constexpr double kForGood = std::numeric_limits<double>::infinity();

/// The second joint's drive has the defect.
app::RunConfig defective(FaultKind kind, double at_s, double until_s, const ScratchFolder& folder,
                         double duration_s = kForGood) {
  app::RunConfig config = driveConfiguration(Drives::kCia402, until_s, folder);
  config.faults = {{.kind = kind, .time_s = at_s, .duration_s = duration_s, .channel = 1}};
  config.rig.faults = config.faults;
  return config;
}

/// Within its budget, from torque on, and for good.
void checkStop(FaultKind kind, Fault fault, double budget_s) {
  CAPTURE(sim::faultKindName(kind));
  const ScratchFolder folder;
  // The rig's time begins with the set-up, which takes some ticks.
  const DriveRun run = runDrives(defective(kind, kAt_s, kAt_s + budget_s, folder));
  CHECK(run.loop.final_state == safety::State::kFault);
  CHECK(run.loop.latched.has(fault));
  CHECK(run.loop.state_ticks[static_cast<std::size_t>(safety::State::kActive)] >= 700);
  const ScratchFolder later_folder;
  const DriveRun later = runDrives(defective(kind, kAt_s, kAt_s + budget_s + 0.5, later_folder));
  CHECK(later.loop.stops == 1);
  CHECK_FALSE(later.enabled[0]);
  CHECK_FALSE(later.line_up_in_run);
}

std::string refusal(const app::RunConfig& config) {
  try {
    runDrives(config);
  } catch (const canopen::NodeError& error) {
    return error.what();
  }
  return "";
}

/// The events of a run into a folder.
std::string events(app::RunConfig config, const ScratchFolder& folder) {
  const std::atomic<bool> never{false};
  app::runLoop(config, folder.path() / "run", never);
  return app::readFile(folder.path() / "run/events.log");
}

}  // namespace

TEST_CASE("a CiA 402 drive that does wrong stops both, with the named fault") {
  checkStop(FaultKind::kDriveSilent, Fault::kEncoderStale, 8e-3);
  checkStop(FaultKind::kDriveReboots, Fault::kEncoderStale, 8e-3);
  checkStop(FaultKind::kDriveReportsFault, Fault::kDriveEmergency, 3e-3);
  checkStop(FaultKind::kDriveReportsFault, Fault::kDriveFault, 4e-3);
  checkStop(FaultKind::kDriveLeaves, Fault::kDriveLeft, 4e-3);
  checkStop(FaultKind::kDriveLosesSync, Fault::kDriveEmergency, 8e-3);
  checkStop(FaultKind::kDriveNotFollowing, Fault::kDriveNotFollowing, 60e-3);
}

TEST_CASE("a CiA 402 drive whose heartbeat alone is missing is offline after its time") {
  const ScratchFolder folder;
  const app::RunConfig config = driveConfiguration(Drives::kCia402, 1.0, folder);
  const DriveRun run = runDrives(config, [](WatchedBus& bus) {
    bus.drop = [&bus](const can::Frame& frame) { return bus.tick > 900 && frame.id == 0x702; };
  });
  CHECK(run.loop.latched == safety::FaultSet{Fault::kDriveOffline});
  CHECK(run.loop.fault_events[static_cast<std::size_t>(Fault::kEncoderStale)] == 0);
  CHECK_FALSE(run.enabled[0]);
  CHECK_FALSE(run.enabled[1]);
}

TEST_CASE("a CiA 402 drive that ignores its controlword does not enter, and there is no torque before") {
  const ScratchFolder folder;
  const DriveRun run = runDrives(defective(FaultKind::kDriveIgnoresEnter, 0.0, 1.2, folder));
  CHECK(run.loop.final_state == safety::State::kFault);
  CHECK(run.loop.latched.has(Fault::kDriveNotEntered));
  CHECK(run.loop.max_torque_Nm == 0.0);
  CHECK_FALSE(run.enabled[0]);
}

TEST_CASE("a CiA 402 drive that has rebooted is not used again, whatever the operator presses") {
  const ScratchFolder folder;
  app::RunConfig config = defective(FaultKind::kDriveReboots, kAt_s, 3.5, folder, 0.2);
  config.rig.operator_buttons.reset_at_s = {2.2, 2.6, 3.0};
  const DriveRun run = runDrives(config);
  CHECK(run.loop.final_state == safety::State::kFault);
  CHECK(run.loop.fault_events[static_cast<std::size_t>(Fault::kDriveOffline)] == 1);
  CHECK_FALSE(run.enabled[0]);
  CHECK_FALSE(run.enabled[1]);
}

TEST_CASE(
    "the operator's reset clears a CiA 402 drive's fault once it has gone, and a second one leads out") {
  for (const bool gone : {true, false}) {
    const ScratchFolder folder;
    app::RunConfig config =
        defective(FaultKind::kDriveReportsFault, kAt_s, 3.0, folder, gone ? 0.2 : kForGood);
    config.rig.operator_buttons.reset_at_s = {2.0, 2.5};
    const DriveRun run = runDrives(config);
    CHECK(run.loop.final_state == (gone ? safety::State::kReady : safety::State::kFault));
    CHECK(run.loop.stops == 1);
    CHECK_FALSE(run.enabled[0]);
    CHECK_FALSE(run.enabled[1]);
  }
}

TEST_CASE("a loop that stands still is missed by the drives: each falls into a fault by itself") {
  const ScratchFolder folder;
  app::RunConfig config = driveConfiguration(Drives::kCia402, 1.5, folder);
  for (sim::FieldDriveOptions& drive : config.rig.field_drives) {
    drive.watchdog_s = 0.0;  // SYNC is not missed, and the heartbeat is
  }
  const DriveRun run = runDrives(config, [](WatchedBus& bus) {
    bus.keep_back = [&bus](const can::Frame& frame) {
      if (bus.tick == 1200 && frame.id == 0x201) {
        bus.stall(50'000'000);
      }
      return false;
    };
  });
  CHECK(run.rig.watchdog_trips == 2);
  CHECK(run.loop.final_state == safety::State::kFault);
  CHECK_FALSE(run.enabled[0]);
  CHECK_FALSE(run.enabled[1]);
}

TEST_CASE("each tick sends both commands, then SYNC; the own heartbeat comes every fifth") {
  int heartbeats = 0;
  const ScratchFolder folder;
  app::RunConfig config = driveConfiguration(Drives::kCia402, 0.9, folder);
  for (const int tick : {800, 801, 802, 803, 804}) {
    const DriveRun run = runDrives(config, [tick](WatchedBus& bus) { bus.watched_tick = tick; });
    const std::vector<can::Frame>& seen = run.seen;
    REQUIRE(seen.size() >= 3);
    CHECK(seen[0].id == 0x201);
    CHECK(seen[1].id == 0x202);
    CHECK(seen[0].data[0] == 0x0F);
    CHECK(seen[2].id == 0x080);
    CHECK(seen[2].length == 0);
    if (seen.size() == 4) {
      CHECK(seen[3].id == 0x77F);
      ++heartbeats;
    }
  }
  CHECK(heartbeats == 1);
}

TEST_CASE("drives that cannot be set up are refused before the first tick, with node, object and reason") {
  const ScratchFolder folder;
  CHECK(
      refusal(defective(FaultKind::kDriveAbortsSdo, 0.0, 1.0, folder)) ==
      "node 2: 6040h: aborted with 08000022h, data cannot be transferred in the present state of the device");
  CHECK(refusal(defective(FaultKind::kDriveWrongRating, 0.0, 1.0, folder))
            .starts_with("node 2: 6076h: rated torque 500 N·m, read in mN·m, expected 0.5 N·m within 2 %"));
  CHECK(
      refusal(defective(FaultKind::kDriveSilent, 0.0, 1.0, folder)).starts_with("node 2: 1000h: no answer"));
  // A run that is refused leaves no recording.
  const std::atomic<bool> never{false};
  CHECK_THROWS_AS(
      app::runLoop(defective(FaultKind::kDriveSilent, 0.0, 1.0, folder), folder.path() / "run", never),
      canopen::NodeError);
  CHECK_FALSE(std::filesystem::exists(folder.path() / "run"));
}

TEST_CASE("the events have emergencies and reboots with node, code and text") {
  const ScratchFolder folder;
  const std::string faulty = events(defective(FaultKind::kDriveReportsFault, 1.0, 1.2, folder), folder);
  CHECK(faulty.find("raised=drive_emergency") != std::string::npos);
  CHECK(faulty.find("node2=emergency code=4310h register=01h text=\"too high temperature of the drive\"") !=
        std::string::npos);
  CHECK(faulty.find("data_sheet_1 file=cia402.eds") != std::string::npos);
  const ScratchFolder second;
  const std::string rebooted = events(defective(FaultKind::kDriveReboots, 1.0, 1.3, second, 0.1), second);
  CHECK(rebooted.find("node2=silent text=\"no heartbeat\"") != std::string::npos);
  CHECK(rebooted.find("node2=boot_up text=\"it has started anew\"") != std::string::npos);
}

TEST_CASE("a sender of SYNC, of network management or of the loop's heartbeat is a foreign commander") {
  for (const std::uint32_t id : {0x080U, 0x000U, 0x77FU, 0x602U}) {
    CAPTURE(id);
    const ScratchFolder folder;
    const DriveRun run = runDrives(driveConfiguration(Drives::kCia402, 1.0, folder), [id](WatchedBus& bus) {
      bus.rename = [&bus, id](can::Frame& frame) {
        if (bus.tick == 900 && frame.id == 0x181) {
          frame.id = id;
        }
      };
    });
    CHECK(run.loop.latched.has(Fault::kForeignCommand));
  }
}
