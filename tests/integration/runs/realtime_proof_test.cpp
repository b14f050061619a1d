// Heap operations and page faults of the loop thread, with controls that show that the instruments work.
#include <Eigen/Core>
#include <doctest/doctest.h>

#include "drivers/clock/clock.hpp"
#include "firmware_app/commands/run_command.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/integration/runs/demonstration.hpp"

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

TEST_CASE("nor does it with any other observer, each of which finds what the model lacks") {
  using app::ObserverKind;
  for (const ObserverKind kind :
       {ObserverKind::kTerminalSliding, ObserverKind::kMomentum, ObserverKind::kExtendedState,
        ObserverKind::kSuperTwisting, ObserverKind::kKalmanTorque, ObserverKind::kKalmanForce}) {
    CAPTURE(app::observerName(kind));
    app::RunConfig config = test::demonstration(2.0);
    config.observer.kind = kind;
    config.observer.terminal_sliding.switching = 60.0;
    config.observer.momentum.bandwidth_Hz = config.observer.extended_state_bandwidth_Hz = everyJoint(10.0);
    config.observer.super_twisting = {.rate_bound = everyJoint(500.0), .root_gain = everyJoint(30.0)};
    config.observer.kalman = {.space = kind == ObserverKind::kKalmanForce
                                           ? estimation::KalmanSettings::Space::kForce
                                           : estimation::KalmanSettings::Space::kJointTorque,
                              .position_noise_rad = 1.4e-5,
                              .velocity_noise_rad_s = 5e-4,
                              .torque_noise_Nm = 0.1,
                              .disturbance_density = everyJoint(300.0),
                              .disturbance_limit = 200.0,
                              .rest_density_Nm = 10.0};
    const app::LoopStatistics statistics = test::runInLockStep(config, false);
    CHECK(statistics.final_state == safety::State::kActive);
    CHECK(statistics.heap_allocations == 0);
    CHECK(statistics.heap_frees == 0);
    const auto samples = static_cast<double>(statistics.sampler_error.count);
    CHECK(samples > 1900);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      CHECK(statistics.sampler_error.sum[joint] / samples < 3.0);  // of 5 and 18 rad/s² rms
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
  config.tick.monitors.emg.flat_time_s = 1.0;  // its electrodes hear nothing
  VirtualClock clock;
  const auto tick = app::makeTick(config);
  tick::TickInput input;
  input.complete = true;
  input.measurement.encoder_steps = 1;
  input.measurement.emg_steps = 1;
  input.measurement.has_velocity = true;
  input.measurement.position_rad.setConstant(2, -0.5);
  input.measurement.velocity_rad_s.setZero(2);
  input.measurement.reportDriveTorque(JointVector::Zero(2));
  const ForbidEigenHeap forbid;
  for (int i = 0; i < 500; ++i) {
    input.measurement.operator_enable = i > 100;
    input.time_s = i * 1e-3;
    tick->step(input);
    tick->prepareNext();
  }
  CHECK(tick->step(input).state == safety::State::kActive);
}
