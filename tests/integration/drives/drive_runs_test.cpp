// A minute on two drives of others at 1 kHz: no frame lost, the leg where it is on the rig's own drives, and
// no heap in the loop; then a run's log played back.
#include <atomic>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/integration/drives/drive_rig.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/sanitized.hpp"

using namespace patella;
using namespace patella::test;

namespace {

constexpr double kMinute_s = unlessSanitized(60.0, 5.0);
constexpr std::uint64_t kTicks = unlessSanitized(60'000U, 5'000U);

}  // namespace

TEST_CASE("a minute on two drives of others is a minute on the rig's own: no frame lost, the same motion") {
  const ScratchFolder own_folder;
  const DriveRun own = runDrives(driveConfiguration(Drives::kBuiltIn, kMinute_s, own_folder));
  REQUIRE(own.loop.final_state == safety::State::kActive);
  for (const Drives drives : {Drives::kMit, Drives::kOdrive, Drives::kMixed, Drives::kCia402}) {
    CAPTURE(static_cast<int>(drives));
    const ScratchFolder folder;
    const DriveRun run = runDrives(driveConfiguration(drives, kMinute_s, folder));
    CHECK(run.loop.ticks == kTicks);
    CHECK(run.loop.final_state == safety::State::kActive);
    CHECK(run.loop.stops == 0);
    CHECK(run.loop.latched == safety::FaultSet{});
    CHECK(run.unused_frames == 0);
    CHECK(run.bus.receive_dropped == 0);
    CHECK(run.bus.send_failed == 0);
    CHECK(run.rig.watchdog_trips == 0);
    // Every tick's command and those of the end reached each drive.
    REQUIRE(run.commands.size() == 2);
    CHECK(run.commands[0] == kTicks + 10);
    CHECK(run.commands[1] == kTicks + 10);
    CHECK_FALSE(run.enabled[0]);
    CHECK_FALSE(run.enabled[1]);
    CHECK_FALSE(run.line_up);
    for (const std::size_t joint : {0U, 1U}) {
      MESSAGE("joint ", joint + 1, ": ", run.tracking_rad(joint), " rad, on the rig's own drives ",
              own.tracking_rad(joint), " rad");
      CHECK(run.tracking_rad(joint) < 1.15 * own.tracking_rad(joint));
      CHECK(run.tracking_rad(joint) > 0.85 * own.tracking_rad(joint));
    }
    CHECK(run.loop.heap_counted == app::CountAllocations::available());
    CHECK(run.loop.heap_allocations == 0);
    CHECK(run.loop.heap_frees == 0);
  }
}

TEST_CASE("a log of two drives is played back frame by frame, entering and leaving included") {
  const std::atomic<bool> never{false};
  for (const Drives drives : {Drives::kMit, Drives::kOdrive, Drives::kMixed, Drives::kCia402}) {
    CAPTURE(static_cast<int>(drives));
    const ScratchFolder folder;
    app::RunConfig config = driveConfiguration(drives, 1.5, folder);
    REQUIRE(app::runLoop(config, folder.path() / "run", never) == app::RunStatus::kOk);
    config.backend = {app::BackendKind::kReplay, (folder.path() / "run/frames.log").string()};
    config.loop.max_ticks = 0;
    config.duration_s = 0.0;
    REQUIRE(app::runLoop(config, folder.path() / "again", never) == app::RunStatus::kOk);
    const auto summary =
        nlohmann::json::parse(app::readFile(folder.path() / "again/summary.json", test::kRecordingText));
    CHECK(summary["replay"]["different_commands"] == 0);
    CHECK(summary["replay"]["frames"] == summary["replay"]["frames_played"]);
    CHECK(summary["ticks"] == 1500);
    const std::string ticks = app::readFile(folder.path() / "run/ticks.csv", test::kRecordingText);
    CHECK(ticks.find("drive_temperature1_degC,drive_temperature2_degC,drive_error1,drive_error2") !=
          std::string::npos);
    CHECK(ticks.find(drives == Drives::kMit      ? ",25,25,0,0,"
                     : drives == Drives::kCia402 ? ",,,0,0,"
                                                 : "36.25,0,0,") != std::string::npos);
  }
}
