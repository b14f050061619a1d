#include "sim/can_rig_runner.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace patella::sim {
namespace {

constexpr std::size_t kFramesPerPoll = 64;

void check(const RigRunOptions& options) {
  if (!(options.duration_s >= 0.0)) {
    throw std::invalid_argument("rig duration_s is " + std::to_string(options.duration_s) +
                                ", expected >= 0");
  }
  if (options.polls_per_period < 1) {
    throw std::invalid_argument("rig polls_per_period is " + std::to_string(options.polls_per_period) +
                                ", expected >= 1");
  }
}

// Hands on which interfaces have changed.
void setInterfaces(const RigRunOptions& options, can::BusSet& down, can::BusSet wanted, std::size_t buses) {
  for (std::size_t bus = 0; options.set_interface_down && bus < buses; ++bus) {
    if (((down ^ wanted) & can::busBit(bus)) != 0) {
      options.set_interface_down(bus, (wanted & can::busBit(bus)) != 0);
    }
  }
  down = wanted;
}

}  // namespace

RigRunStatistics runRig(Rig& rig, can::Bus& bus, Clock& clock, const std::atomic<bool>& stop,
                        const RigRunOptions& options) {
  check(options);
  RigRunStatistics statistics;
  std::array<can::Frame, kFramesPerPoll> received;
  can::Frame frame;
  can::BusSet interfaces_down = 0;
  const std::int64_t start_ns = clock.now();
  const std::int64_t end_ns =
      options.duration_s > 0.0 ? start_ns + static_cast<std::int64_t>(std::llround(options.duration_s * 1e9))
                               : std::numeric_limits<std::int64_t>::max();
  std::int64_t instant_ns = start_ns;
  // Polls are numbered, so that a period that does not divide leaves no drift against the samples.
  for (std::int64_t poll = 0; instant_ns <= end_ns && !stop.load(std::memory_order_relaxed);) {
    clock.sleepUntil(instant_ns);
    rig.advance(instant_ns);
    setInterfaces(options, interfaces_down, rig.interfacesDown(), rig.buses());
    while (rig.pop(frame)) {
      const bool sent = bus.send(frame, instant_ns) == can::SendResult::kSent;
      ++(sent ? statistics.frames_sent : statistics.send_failed);
    }
    const std::size_t count = bus.receive(received, instant_ns);
    statistics.frames_received += count;
    for (std::size_t i = 0; i < count; ++i) {
      rig.accept(received[i]);
    }
    statistics.duration_s = static_cast<double>(instant_ns - start_ns) * 1e-9;
    ++poll;
    instant_ns = start_ns + poll * rig.sensorPeriod_ns() / options.polls_per_period;
  }
  setInterfaces(options, interfaces_down, 0, rig.buses());  // the host is left as it was
  statistics.rig = rig.statistics();
  return statistics;
}

}  // namespace patella::sim
