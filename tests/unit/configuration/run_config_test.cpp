// Configuration of a run, by file and by command line. tests/integration/malformed has malformed input.
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

TEST_CASE("another model of the loop leaves the rig what it is, and the other way round") {
  const auto models = std::filesystem::path(PATELLA_SOURCE_DIR) / "firmware_app/config/models";
  const RunConfig plain = loadRunConfig(shipped());
  REQUIRE(plain.model.effects.size() == 2);
  REQUIRE(plain.rig_model.effects.size() == 4);

  CommandLine loop = shipped();
  loop.model = models / "physical.toml";
  const RunConfig told = loadRunConfig(loop);
  CHECK(told.model_path == *loop.model);
  CHECK(told.rig_model_path == plain.rig_model_path);
  CHECK(told.rig_model.effects.size() == 4);

  CommandLine rig = shipped();
  rig.rig_model = models / "adult.toml";
  const RunConfig real = loadRunConfig(rig);
  CHECK(real.model_path == plain.model_path);
  CHECK(real.rig_model_path == *rig.rig_model);
  CHECK(real.rig_model.effects.size() == 2);

  CommandLine misfit = shipped();
  misfit.rig_model = std::filesystem::path(PATELLA_SOURCE_DIR) / "tools/diagnose/maps/emps_inertia.toml";
  CHECK_THROWS_AS(loadRunConfig(misfit), std::invalid_argument);
}

TEST_CASE("a reference from a file replaces the configuration's") {
  using patella::control::MultisineMotion;
  using patella::control::SinusoidMotion;
  CommandLine line = shipped();
  REQUIRE(std::holds_alternative<SinusoidMotion>(loadRunConfig(line).tick.reference.motion[0]));
  line.reference = std::filesystem::path(PATELLA_SOURCE_DIR) / "firmware_app/config/references/unseen.toml";
  const RunConfig config = loadRunConfig(line);
  CHECK(config.reference_path == *line.reference);
  const auto* waves = std::get_if<MultisineMotion>(&config.tick.reference.motion[0]);
  REQUIRE(waves != nullptr);
  REQUIRE(waves->components.size() == 4);
  CHECK(waves->offset_rad == -1.25);
  CHECK(waves->components[1].frequency_Hz == 0.41);
  CHECK(waves->components[1].amplitude_rad == 0.2);
  CHECK(waves->components[1].phase_rad == patella::control::schroederPhase_rad(1, 4));
  line.reference = *line.reference / "missing.toml";
  CHECK_THROWS_AS(loadRunConfig(line), FileError);
}
