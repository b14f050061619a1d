// Heap operations and page faults of the loop thread in wall-clock time.
#include <atomic>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/integration/runs/demonstration.hpp"

using namespace patella;

TEST_CASE("a run in wall-clock time shows no heap operation and no page fault after warm-up") {
  const test::ScratchFolder folder;
  app::RunConfig config = test::demonstration(2.0, "sim", "monotonic");
  config.realtime.priority = 0;  // punctuality is not the subject, and a test must not starve its neighbours
  config.bus.map.encoder_timeout_s = 1.0;
  config.bus.map.drive_timeout_s = 1.0;
  config.bus.map.emg_timeout_s = 1.0;
  config.tick.monitors.emg.hum_time_s = 1.0;
  config.rig.drive.watchdog_s = 1.0;
  config.tick.monitors.drive.follow_time_s = 1.0;
  config.loop.stall_tolerated_s = 1.0;
  config.watchdog.timeout_s = 0.5;
  config.loop.overruns_tolerated = 100;
  const std::atomic<bool> stop{false};
  CHECK(app::runLoop(config, folder.path() / "run", stop) == app::RunStatus::kOk);

  const auto summary = nlohmann::json::parse(app::readFile(folder.path() / "run" / "summary.json"));
  CHECK(summary["loop_thread"]["heap_allocations"] == 0);
  CHECK(summary["loop_thread"]["heap_frees"] == 0);
  CHECK(summary["loop_thread"]["major_page_faults"] == 0);
  if (summary["realtime"]["memory_locked"] == true && app::CountAllocations::available()) {
    CHECK(summary["loop_thread"]["minor_page_faults"] == 0);
  } else {
    MESSAGE("memory is not locked here, or a sanitizer moves it: minor faults are not judged");
  }
}
