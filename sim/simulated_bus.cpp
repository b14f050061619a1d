#include "sim/simulated_bus.hpp"

namespace patella::sim {

std::size_t SimulatedBus::receive(std::span<can::Frame> frames,
                                  std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  rig_.advance(now_ns);
  errors_.beginReceive();
  arrivals_.begin(now_ns, now_ns + rig_.wallStep_ns());
  std::size_t count = 0;
  while (count < frames.size() && rig_.pop(frames[count])) {
    can::Frame& frame = frames[count++];
    frame.monotonic_ns = now_ns;
    arrivals_.date(frame, wall_offset_ns_);
    errors_.observe(frame, statistics_[frame.bus]);
    statistics_[frame.bus].frames_received += frame.error ? 0U : 1U;
  }
  if (count < frames.size()) {
    arrivals_.emptied();
  }
  return count;
}

can::SendResult SimulatedBus::send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  if ((downBuses() & can::busBit(frame.bus)) != 0) {
    ++statistics_[frame.bus].send_failed;
    return can::SendResult::kDown;
  }
  frame.monotonic_ns = now_ns;
  frame.wall_ns = now_ns + wall_offset_ns_;
  rig_.advance(now_ns);
  rig_.accept(frame);
  ++statistics_[frame.bus].frames_sent;
  return can::SendResult::kSent;
}

can::BusStatistics SimulatedBus::statistics() const noexcept {
  can::BusStatistics statistics = statistics_.total();
  statistics.receive_dropped = rig_.statistics().frames_dropped;
  return statistics;
}

}  // namespace patella::sim
