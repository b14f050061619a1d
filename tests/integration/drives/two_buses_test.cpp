// The leg with a drive on each of two buses: the same motion as on one, and whatever happens to one bus, the
// drive on the other is without torque within two ticks.
#include <atomic>
#include <csignal>
#include <functional>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/integration/drives/drive_rig.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/sanitized.hpp"

using namespace patella;
using namespace patella::test;
using safety::Fault;

namespace {

constexpr double kAt_s = 1.5;
constexpr double kAfter_s = 0.3;
constexpr std::uint8_t kHip = 0;
constexpr std::uint8_t kKnee = 1;

/// A command as it went out.
struct Sent {
  int tick = 0;
  std::uint8_t bus = 0;
  bool torque = false;
};

struct FaultRun {
  DriveRun run;
  std::vector<Sent> commands;
  int fault_tick = 0;  ///< first one in the state fault
};

FaultRun faultyRun(const sim::FaultEvent& event,
                   const std::function<bool(const can::Frame&, int)>& keep_back = {}) {
  const ScratchFolder folder;
  app::RunConfig config = driveConfiguration(Drives::kTwoBuses, kAt_s + kAfter_s, folder);
  if (!keep_back) {
    config.faults = {event};
    config.rig.faults = config.faults;
  }
  FaultRun faulty;
  faulty.commands.reserve(10'000);
  faulty.run = runDrives(config, [&](WatchedBus& bus) {
    bus.keep_back = [&faulty, &bus, keep_back](const can::Frame& frame) {
      const bool kept = keep_back && keep_back(frame, bus.tick);
      if (!kept && (frame.id == 0x201 || frame.id == 0x202) && bus.tick >= 0) {
        faulty.commands.push_back({bus.tick, frame.bus, frame.data[2] != 0 || frame.data[3] != 0});
      }
      return kept;
    };
  });
  const auto in_fault = faulty.run.loop.state_ticks[static_cast<std::size_t>(safety::State::kFault)];
  faulty.fault_tick = static_cast<int>(faulty.run.loop.ticks - in_fault);
  return faulty;
}

/// The fault is latched and named, with its bus; no torque on either bus from two ticks after it on, though
/// there was before; the line is low.
void checkStopped(const FaultRun& faulty, Fault fault, std::uint8_t bus) {
  CAPTURE(safety::faultName(fault));
  const app::LoopStatistics& loop = faulty.run.loop;
  CHECK(loop.final_state == safety::State::kFault);
  CHECK(loop.latched.has(fault));
  CHECK(loop.stops == 1);
  CHECK(loop.bus_fault_ticks[bus] > 0);
  CHECK(loop.bus_fault_ticks[1U - bus] == 0);
  CHECK_FALSE(faulty.run.line_up_in_run);
  CHECK_FALSE(faulty.run.enabled[1U - bus]);
  bool before = false;
  bool after = false;
  for (const Sent& sent : faulty.commands) {
    before = before || (sent.torque && sent.tick < faulty.fault_tick);
    after = after || (sent.torque && sent.tick >= faulty.fault_tick + 2);
  }
  CHECK(before);
  CHECK_FALSE(after);
}

}  // namespace

TEST_CASE("a drive on each of two buses: the motion of one bus, no frame lost, no heap") {
  constexpr double kRun_s = unlessSanitized(10.0, 3.0);
  const ScratchFolder one_folder;
  const DriveRun one = runDrives(driveConfiguration(Drives::kCia402, kRun_s, one_folder));
  const ScratchFolder folder;
  const DriveRun two = runDrives(driveConfiguration(Drives::kTwoBuses, kRun_s, folder));
  CHECK(two.loop.final_state == safety::State::kActive);
  CHECK(two.loop.stops == 0);
  CHECK(two.unused_frames == 0);
  CHECK(two.bus.send_failed == 0);
  CHECK(two.rig.watchdog_trips == 0);
  for (const std::size_t joint : {0U, 1U}) {
    MESSAGE("joint ", joint + 1, ": ", two.tracking_rad(joint), " rad, on one bus ", one.tracking_rad(joint),
            " rad");
    CHECK(two.tracking_rad(joint) == doctest::Approx(one.tracking_rad(joint)).epsilon(0.01));
    CHECK(two.commands[joint] == one.commands[joint]);
  }
  CHECK(two.loop.heap_counted == app::CountAllocations::available());
  CHECK(two.loop.heap_allocations == 0);
  CHECK(two.loop.heap_frees == 0);
}

TEST_CASE("two buses: each has its own SYNC, heartbeat and command, and nothing of the other") {
  const ScratchFolder folder;
  const DriveRun run = runDrives(driveConfiguration(Drives::kTwoBuses, 1.0, folder),
                                 [](WatchedBus& bus) { bus.watched_tick = 805; });
  std::vector<std::uint32_t> hip, knee;
  for (const can::Frame& frame : run.seen) {
    (frame.bus == kHip ? hip : knee).push_back(frame.id);
  }
  CHECK(hip == std::vector<std::uint32_t>{0x201, 0x080, 0x77F});
  CHECK(knee == std::vector<std::uint32_t>{0x202, 0x080, 0x77F});
}

TEST_CASE("two buses: one that goes off, on either side, stops both") {
  for (const std::uint8_t bus : {kHip, kKnee}) {
    for (const sim::FaultKind kind : {sim::FaultKind::kBusOff, sim::FaultKind::kInterfaceDown}) {
      CAPTURE(sim::faultKindName(kind));
      const FaultRun faulty = faultyRun({.kind = kind, .time_s = kAt_s, .bus = bus});
      checkStopped(faulty, Fault::kBusOff, bus);
    }
  }
}

TEST_CASE("two buses: one on which nobody is heard any more stops both") {
  for (const std::uint8_t bus : {kHip, kKnee}) {
    const FaultRun faulty = faultyRun({.kind = sim::FaultKind::kLostFrames, .time_s = kAt_s, .bus = bus});
    checkStopped(faulty, Fault::kEncoderStale, bus);
  }
}

TEST_CASE("two buses: one that takes no frame any more stops both, the other one in the same tick") {
  for (const std::uint8_t bus : {kHip, kKnee}) {
    constexpr int kFrom = 1200;
    const FaultRun faulty =
        faultyRun({}, [bus](const can::Frame& frame, int tick) { return tick >= kFrom && frame.bus == bus; });
    // The drive's own watchdog of SYNC comes before the fourth lost command: its report is the cause, or the
    // loop's own.
    const app::LoopStatistics& loop = faulty.run.loop;
    CHECK(loop.final_state == safety::State::kFault);
    CHECK(loop.bus_fault_ticks[bus] > 0);
    CHECK(loop.bus_fault_ticks[1U - bus] == 0);
    CHECK_FALSE(faulty.run.line_up_in_run);
    bool torque = false;
    for (std::size_t i = 0; i < faulty.commands.size(); ++i) {
      const bool last_of_tick =
          i + 1 == faulty.commands.size() || faulty.commands[i + 1].tick != faulty.commands[i].tick;
      torque = torque || (last_of_tick && faulty.commands[i].tick >= kFrom && faulty.commands[i].torque);
    }
    CHECK_FALSE(torque);
  }
}

TEST_CASE(
    "two buses: the log has both interfaces, is played back frame by frame, and the event names the bus") {
  const std::atomic<bool> never{false};
  const ScratchFolder folder;
  app::RunConfig config = driveConfiguration(Drives::kTwoBuses, kAt_s + kAfter_s, folder);
  config.faults = {{.kind = sim::FaultKind::kBusOff, .time_s = kAt_s, .bus = kKnee}};
  config.rig.faults = config.faults;
  REQUIRE(app::runLoop(config, folder.path() / "run", never) == app::RunStatus::kStopped);
  const std::string events = app::readFile(folder.path() / "run/events.log", test::kRecordingText);
  CHECK(events.find("raised=bus_off bus=knee\n") != std::string::npos);
  CHECK(events.find("bus=hip") == std::string::npos);
  const auto summary =
      nlohmann::json::parse(app::readFile(folder.path() / "run/summary.json", test::kRecordingText));
  CHECK(summary["buses"]["hip"]["interface"] == "can0");
  CHECK(summary["buses"]["hip"]["bus_off"] == 0);
  CHECK(summary["buses"]["knee"]["bus_off"] == 1);
  CHECK(summary["buses"]["knee"]["send_failed"] > 0);
  const std::string log = app::readFile(folder.path() / "run/frames.log", test::kRecordingText);
  CHECK(log.find(" can0 201#") != std::string::npos);
  CHECK(log.find(" can1 202#") != std::string::npos);
  CHECK(log.find(" can0 202#") == std::string::npos);
  CHECK(log.find(" can1 181#") == std::string::npos);

  config.faults.clear();
  config.backend = {app::BackendKind::kReplay, (folder.path() / "run/frames.log").string()};
  config.loop.max_ticks = 0;
  config.duration_s = 0.0;
  REQUIRE(app::runLoop(config, folder.path() / "again", never) == app::RunStatus::kOk);
  const auto again =
      nlohmann::json::parse(app::readFile(folder.path() / "again/summary.json", test::kRecordingText));
  CHECK(again["ticks"] == summary["ticks"]);
  for (const char* fault : {"bus_off", "encoder_stale", "emg_stale"}) {
    CHECK(again["safety"]["faults"][fault] == summary["safety"]["faults"][fault]);
  }
  CHECK(again["replay"]["frames"] == again["replay"]["frames_played"]);
  config.buses[1].interface = "can7";
  CHECK_THROWS_WITH(app::runLoop(config, folder.path() / "third", never),
                    doctest::Contains("a frame of interface 'can1', expected one of the configuration's: "
                                      "can0, can7"));
}
