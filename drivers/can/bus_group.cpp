#include "drivers/can/bus_group.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace patella::can {

BusGroup::BusGroup(std::vector<std::unique_ptr<Bus>> buses) : buses_(std::move(buses)) {
  if (buses_.empty() || buses_.size() > kMaxBuses) {
    throw std::invalid_argument("a group of " + std::to_string(buses_.size()) + " buses, expected 1 to " +
                                std::to_string(kMaxBuses));
  }
}

void BusGroup::discardPending() noexcept {
  for (const auto& bus : buses_)
    bus->discardPending();
}

std::size_t BusGroup::receive(std::span<Frame> frames, std::int64_t now_ns) noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    const std::size_t part = (frames.size() - count) / (buses_.size() - i);
    const std::size_t got = buses_[i]->receive(frames.subspan(count, part), now_ns);
    for (Frame& frame : frames.subspan(count, got))
      frame.bus = static_cast<std::uint8_t>(i);
    count += got;
  }
  return count;
}

SendResult BusGroup::send(Frame& frame, std::int64_t now_ns) noexcept {
  return frame.bus < buses_.size() ? buses_[frame.bus]->send(frame, now_ns) : SendResult::kDown;
}

BusSet BusGroup::downBuses() const noexcept {
  BusSet down = 0;
  for (std::size_t i = 0; i < buses_.size(); ++i)
    down = static_cast<BusSet>(down | (buses_[i]->down() ? busBit(i) : 0));
  return down;
}

BusStatistics BusGroup::statistics() const noexcept {
  BusStatistics total;
  for (const auto& bus : buses_)
    total += bus->statistics();
  return total;
}

BusStatistics BusGroup::statisticsOf(std::size_t bus) const noexcept {
  return bus < buses_.size() ? buses_[bus]->statistics() : BusStatistics{};
}

std::size_t OneOfBuses::receive(std::span<Frame> frames, std::int64_t now_ns) noexcept {
  std::size_t kept = 0;
  bool more = true;
  // What is passed over leaves room: less than `frames` has to mean that nothing more is there.
  while (more && kept < frames.size()) {
    const std::span<Frame> room = frames.subspan(kept);
    const std::size_t count = buses_.receive(room, now_ns);
    more = count == room.size();
    for (const Frame& frame : room.first(count)) {
      if (frame.bus == bus_)
        frames[kept++] = frame;
    }
  }
  return kept;
}

}  // namespace patella::can
