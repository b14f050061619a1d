// What a run is told, and who wins. Malformed input is the matter of tests/integration/malformed.
#include "firmware_app/configuration/run_config.hpp"

#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/support/paths.hpp"

using namespace patella::app;

namespace {

CommandLine shipped() {
  CommandLine line;
  line.config = std::filesystem::path(PATELLA_SOURCE_DIR) / "firmware_app/config/adult.toml";
  return line;
}

}  // namespace

TEST_CASE("backends by name") {
  CHECK(parseBackend("sim").kind == BackendKind::kSim);
  const Backend can = parseBackend("can:vcan0");
  CHECK(can.kind == BackendKind::kCan);
  CHECK(can.target == "vcan0");
  const Backend replay = parseBackend("replay:runs/a:b/frames.log");
  CHECK(replay.kind == BackendKind::kReplay);
  CHECK(replay.target == "runs/a:b/frames.log");
  for (const char* text : {"", "Sim", "can", "can:", "replay:", "usb:0"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseBackend(text), std::invalid_argument);
  }
}

TEST_CASE("the command line wins over the file") {
  CommandLine line = shipped();
  line.clock = "virtual";
  line.duration_s = 2.0;
  line.rate_Hz = 500.0;
  line.seed = 42;
  const RunConfig config = loadRunConfig(line);
  CHECK(config.clock == ClockKind::kVirtual);
  CHECK(config.loop.max_ticks == 1000);
  CHECK(config.tick.period_s == 0.002);
  CHECK(config.rig.seed == 42);
  CHECK(loadRunConfig(shipped()).rig.seed == 1);
}

TEST_CASE("a log is played on the virtual clock whatever the file says, a bus never is") {
  CommandLine replay = shipped();
  replay.backend = "replay:frames.log";
  CHECK(loadRunConfig(replay).clock == ClockKind::kVirtual);
  CommandLine bus = shipped();
  bus.backend = "can:can0";
  CHECK(loadRunConfig(bus).clock == ClockKind::kMonotonic);
  bus.clock = "virtual";
  CHECK_THROWS_AS(loadRunConfig(bus), std::invalid_argument);
}
