#include "sim/simulated_bus.hpp"

#include <array>
#include <atomic>

#include <doctest/doctest.h>

#include "drivers/can/message_codec.hpp"
#include "sim/can_rig_runner.hpp"
#include "sim/rig_thread.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/sim/rig_fixture.hpp"

using namespace patella;
using namespace patella::sim;

namespace {

/// Runs a loop that answers each tick with a torque from the newest knee position.
std::vector<can::Frame> lockStepRun(const RigOptions& options, int ticks) {
  Rig rig(options, rigDatabase());
  VirtualClock clock(1'700'000'000'000'000'000);
  SimulatedBus bus(rig, clock);
  CommandPen pen;
  can::MessageDecoder encoder(rigDatabase().message("Encoder2"));
  const std::size_t position = encoder.slot("Position");
  std::vector<can::Frame> record;
  std::array<can::Frame, 64> frames;
  double knee_rad = 0.0;
  for (int k = 1; k <= ticks; ++k) {
    clock.sleepUntil(k * kMillisecond_ns);
    const std::size_t count = bus.receive(frames, clock.now());
    for (std::size_t i = 0; i < count; ++i) {
      knee_rad = encoder.matches(frames[i]) ? encoder.value(frames[i], position) : knee_rad;
      record.push_back(frames[i]);
    }
    can::Frame command = pen.write(0.5, -2.0 * knee_rad);
    REQUIRE(bus.send(command, clock.now()) == can::SendResult::kSent);
    record.push_back(command);
  }
  return record;
}

RigOptions noisyRig() {
  RigOptions options = paperRig();
  options.interaction = {.kind = InteractionKind::kHuman};
  options.encoder = {.bits_per_turn = 14, .velocity_noise_sd_rad_s = 0.02};
  options.drive.report_noise_sd_Nm = 0.02;
  return options;
}

}  // namespace

TEST_CASE("two lock-step runs are the same to the bit, another seed is not") {
  const std::vector<can::Frame> a = lockStepRun(noisyRig(), 1500);
  const std::vector<can::Frame> b = lockStepRun(noisyRig(), 1500);
  RigOptions reseeded = noisyRig();
  reseeded.seed = 2;
  const std::vector<can::Frame> c = lockStepRun(reseeded, 1500);
  REQUIRE(a.size() == b.size());
  REQUIRE(a.size() == c.size());
  std::size_t equal = 0;
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    equal += a[i].id == b[i].id && a[i].data == b[i].data && a[i].wall_ns == b[i].wall_ns &&
                     a[i].monotonic_ns == b[i].monotonic_ns
                 ? 1U
                 : 0U;
    different += a[i].data != c[i].data ? 1U : 0U;
  }
  CHECK(equal == a.size());
  CHECK(different > a.size() / 2);
}

TEST_CASE("a tick sees the sample of its own instant, and its command acts from there") {
  Rig rig(paperRig(), rigDatabase());
  VirtualClock clock(5'000);
  SimulatedBus bus(rig, clock);
  CommandPen pen;
  std::array<can::Frame, 16> frames;
  can::MessageDecoder encoder(rigDatabase().message("Encoder1"));
  const std::size_t velocity = encoder.slot("Velocity");

  CHECK(bus.receive(frames, 7 * kMillisecond_ns) == 6);
  can::Frame command = pen.write(1.0, 0.0);
  CHECK(bus.send(command, 7 * kMillisecond_ns) == can::SendResult::kSent);
  CHECK(command.monotonic_ns == 7 * kMillisecond_ns);
  CHECK(command.wall_ns == 7 * kMillisecond_ns + 5'000);

  CHECK(bus.receive(frames, 8 * kMillisecond_ns + 200) == 5);
  REQUIRE(encoder.matches(frames[0]));
  CHECK(frames[0].wall_ns == 8 * kMillisecond_ns + 5'000);
  CHECK(frames[0].monotonic_ns == 8 * kMillisecond_ns + 200);
  CHECK(frames[0].age_ns == 200);
  // 1 ms of 1 N·m on the paper leg's hip adds a rate of inverse inertia times a millisecond.
  const model::PlanarTwoLink leg(model::paperLeg().parameters);
  const JointMatrix inertia = leg.inertia(rig.plant().state().q);
  const double expected =
      1e-3 * inertia(1, 1) / (inertia(0, 0) * inertia(1, 1) - inertia(0, 1) * inertia(1, 0));
  CHECK(encoder.value(frames[0], velocity) == doctest::Approx(expected).epsilon(0.1));

  // Frames that do not fit stay for the next call.
  CHECK(bus.receive(std::span(frames).first(2), 9 * kMillisecond_ns) == 2);
  CHECK(bus.receive(frames, 9 * kMillisecond_ns) == 3);
  CHECK(bus.statistics().frames_received == 16);
  CHECK(bus.statistics().frames_sent == 1);
}

TEST_CASE("nothing is allocated once the rig stands") {
  RigOptions options = noisyRig();
  options.drive.bandwidth_Hz = 200.0;
  options.operator_buttons.reset_at_s = {0.1, 0.3};
  Rig rig(options, rigDatabase());
  VirtualClock clock;
  SimulatedBus bus(rig, clock);
  CommandPen pen;
  std::array<can::Frame, 16> frames;
  std::size_t received = 0;
  const std::uint64_t before = test::allocationCount();
  for (int k = 1; k <= 500; ++k) {
    received += bus.receive(frames, k * kMillisecond_ns);
    can::Frame command = pen.write(0.3, 0.1);
    bus.send(command, k * kMillisecond_ns);
  }
  CHECK(test::allocationCount() - before == 0);
  CHECK(received == 500 * 5 + 50);
}

TEST_CASE("a rig on its own thread answers over its rings, and obeys") {
  Rig rig(paperRig(), rigDatabase());
  MonotonicClock clock;
  RigThread bus(rig, clock);
  CommandPen pen;
  can::Frame early = pen.write(0.0, 0.0);
  CHECK(bus.send(early, clock.now()) == can::SendResult::kDown);
  CHECK(bus.down());

  bus.start();
  CHECK_FALSE(bus.down());
  std::array<can::Frame, 64> frames;
  const can::MessageDecoder encoder(rigDatabase().message("Encoder1"));
  std::int64_t previous_stamp = 0;
  std::size_t samples = 0;
  std::size_t disordered = 0;
  std::uint64_t sent = 0;
  std::uint64_t allocated = 0;
  std::int64_t instant_ns = clock.now();
  while (samples < 200) {
    instant_ns += kMillisecond_ns;
    clock.sleepUntil(instant_ns);
    const std::uint64_t before = test::allocationCount();
    const std::size_t count = bus.receive(frames, instant_ns);
    can::Frame command = pen.write(0.4, 0.0);
    sent += bus.send(command, instant_ns) == can::SendResult::kSent ? 1U : 0U;
    allocated += test::allocationCount() - before;
    for (std::size_t i = 0; i < count; ++i) {
      if (encoder.matches(frames[i])) {
        disordered += samples > 0 && frames[i].wall_ns - previous_stamp != kMillisecond_ns ? 1U : 0U;
        previous_stamp = frames[i].wall_ns;
        ++samples;
      }
    }
  }
  bus.stop();
  CHECK(bus.down());
  CHECK(disordered == 0);
  CHECK(allocated == 0);
  CHECK(rig.statistics().commands_accepted > 0);
  CHECK(rig.statistics().commands_accepted <= sent);
  CHECK(rig.statistics().commands_rejected == 0);
  CHECK(rig.statistics().max_torque_Nm == doctest::Approx(0.4));
}

namespace {

/// A wire whose other end the test holds.
class LoopbackBus final : public can::Bus {
 public:
  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t /*now_ns*/) noexcept PATELLA_NONBLOCKING override {
    if (sent % commands_every != 0 || sent == answered) {
      return 0;
    }
    answered = sent;
    frames[0] = pen.write(0.7, 0.0);
    return 1;
  }
  can::SendResult send(can::Frame& /*frame*/, std::int64_t /*now_ns*/) noexcept PATELLA_NONBLOCKING override {
    ++sent;
    return sent <= accepts ? can::SendResult::kSent : can::SendResult::kQueueFull;
  }
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

  CommandPen pen;
  std::uint64_t commands_every = 1;
  std::uint64_t accepts = 1'000'000;
  std::uint64_t sent = 0;
  std::uint64_t answered = 0;
};

}  // namespace

TEST_CASE("the runner sends each sample on its instant, obeys commands and counts") {
  RigOptions options = paperRig();
  Rig rig(options, rigDatabase());
  VirtualClock clock;
  LoopbackBus bus;
  bus.accepts = 400;
  const std::atomic<bool> stop{false};
  const RigRunStatistics statistics = runRig(rig, bus, clock, stop, {.duration_s = 0.1});
  CHECK(statistics.duration_s == doctest::Approx(0.1));
  CHECK(statistics.rig.samples == 101);
  CHECK(statistics.frames_sent == 400);
  CHECK(statistics.send_failed == 101 * 5 + 11 - 400);
  CHECK(statistics.rig.commands_accepted == statistics.frames_received);
  CHECK(statistics.rig.commands_accepted == 101);
  CHECK(statistics.rig.max_torque_Nm == doctest::Approx(0.7));
  CHECK(statistics.rig.watchdog_trips == 0);
  CHECK(clock.now() == 100 * kMillisecond_ns);
}

TEST_CASE("the runner stops when told and refuses impossible options") {
  Rig rig(paperRig(), rigDatabase());
  VirtualClock clock;
  LoopbackBus bus;
  const std::atomic<bool> stop{true};
  CHECK(runRig(rig, bus, clock, stop).rig.samples == 0);
  CHECK_THROWS_AS(runRig(rig, bus, clock, stop, {.duration_s = -1.0}), std::invalid_argument);
  CHECK_THROWS_AS(runRig(rig, bus, clock, stop, {.polls_per_period = 0}), std::invalid_argument);
}
