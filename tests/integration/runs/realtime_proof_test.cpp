// What the loop thread does to heap and memory, with controls that show that the instruments work.
#include <Eigen/Core>
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/integration/runs/run_folder.hpp"

using namespace patella;

namespace {

// Eigen's own switch: in builds with assertions, heap use inside Eigen ends the program.
struct ForbidEigenHeap {
  ForbidEigenHeap() { Eigen::internal::set_is_malloc_allowed(false); }
  ~ForbidEigenHeap() { Eigen::internal::set_is_malloc_allowed(true); }
};

}  // namespace

TEST_CASE("the loop thread neither allocates nor frees, with a network of either depth and precision") {
  for (const int layers : {1, 2}) {
    for (const auto precision : {network::Precision::kFloat32, network::Precision::kInt16}) {
      CAPTURE(layers);
      app::RunConfig config = test::demonstration(3.0);
      config.weights = test::randomNetwork(layers);
      config.inference.precision = precision;
      config.tick.compensation = tick::CompensationSource::kSampler;
      const app::LoopStatistics statistics = test::runInLockStep(config, false);
      CHECK(statistics.ticks == 3000);
      CHECK(statistics.final_state == safety::State::kActive);
      CHECK(statistics.network_error.count > 2900);
      CHECK(statistics.heap_counted == app::CountAllocations::available());
      CHECK(statistics.heap_allocations == 0);
      CHECK(statistics.heap_frees == 0);
    }
  }
}

TEST_CASE("a loop that does allocate is found out") {
  if (!app::CountAllocations::available()) {
    MESSAGE("not counted in a sanitizer build");
    return;
  }
  const app::LoopStatistics statistics = test::runInLockStep(test::demonstration(1.0), true);
  const auto counted_ticks = statistics.ticks - 200;  // the warm-up is not counted
  CHECK(statistics.heap_allocations >= counted_ticks);
  CHECK(statistics.heap_frees >= counted_ticks);
}

TEST_CASE("Eigen asks for no heap in the loop") {
  app::RunConfig config = test::demonstration(1.0);
  config.weights = test::randomNetwork(2);
  VirtualClock clock;
  const auto tick = app::makeTick(config);
  tick::TickInput input;
  input.complete = true;
  input.measurement.encoder_steps = 1;
  input.measurement.emg_steps = 1;
  input.measurement.has_velocity = true;
  for (JointVector* vector : {&input.measurement.position_rad, &input.measurement.velocity_rad_s,
                              &input.measurement.drive_torque_Nm}) {
    vector->setConstant(2, -0.5);
  }
  const ForbidEigenHeap forbid;
  for (int i = 0; i < 500; ++i) {
    input.measurement.operator_enable = i > 100;
    input.time_s = i * 1e-3;
    tick->step(input);
    tick->prepareNext();
  }
  CHECK(tick->step(input).state == safety::State::kActive);
}

TEST_CASE("a run in wall-clock time shows no heap operation and no page fault after warm-up") {
  const test::TemporaryFolder folder;
  app::RunConfig config = test::demonstration(2.0, "sim", "monotonic");
  config.realtime.priority = 0;  // punctuality is not the subject, and a test must not starve its neighbours
  config.bus.map.encoder_timeout_s = 1.0;
  config.bus.map.drive_timeout_s = 1.0;
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
