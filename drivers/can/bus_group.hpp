// Several buses as one: the loop has one thread and one tick, whatever the number of its interfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "drivers/can/bus.hpp"

namespace patella::can {

/// Frames carry the number of their bus in both directions. A bus that is down takes nothing from the others:
/// each has its own socket, queue and error state.
class BusGroup final : public Bus {
 public:
  /// Bus number i is the i-th. Throws std::invalid_argument unless there are 1 to kMaxBuses.
  explicit BusGroup(std::vector<std::unique_ptr<Bus>> buses);

  void discardPending() noexcept override;
  /// Bus after bus, on each the oldest first. One that is flooded leaves the others their equal part of
  /// `frames`.
  std::size_t receive(std::span<Frame> frames, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  /// kDown for a frame of a bus that there is not.
  SendResult send(Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  bool down() const noexcept override { return downBuses() != 0; }
  BusSet downBuses() const noexcept override;
  BusStatistics statistics() const noexcept override;
  BusStatistics statisticsOf(std::size_t bus) const noexcept override;

 private:
  std::vector<std::unique_ptr<Bus>> buses_;
};

/// One bus out of several, for those who know of one alone: what comes on the others is passed over. For use
/// before the first tick.
class OneOfBuses final : public Bus {
 public:
  /// `buses` must outlive this.
  OneOfBuses(Bus& buses, std::uint8_t bus) noexcept : buses_(buses), bus_(bus) {}

  std::size_t receive(std::span<Frame> frames, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  SendResult send(Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    frame.bus = bus_;
    return buses_.send(frame, now_ns);
  }
  bool down() const noexcept override { return (buses_.downBuses() & busBit(bus_)) != 0; }
  BusStatistics statistics() const noexcept override { return buses_.statisticsOf(bus_); }

 private:
  Bus& buses_;
  std::uint8_t bus_;
};

}  // namespace patella::can
