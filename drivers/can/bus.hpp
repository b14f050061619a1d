// The one seam through which the loop reaches its rig. Backends: SocketCanBus, SimulatedBus, ReplayBus.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"

namespace patella::can {

enum class SendResult : std::uint8_t {
  kSent,
  kQueueFull,  ///< ENOBUFS or EAGAIN: the command is lost, not delayed
  kDown,       ///< interface down or gone, or bus-off
};

/// Counters since opening; plain numbers, read between ticks.
struct BusStatistics {
  std::uint64_t frames_received = 0;
  std::uint64_t frames_sent = 0;
  std::uint64_t receive_dropped = 0;  ///< lost in the kernel's socket queue (SO_RXQ_OVFL)
  std::uint64_t send_failed = 0;
  std::uint64_t error_frames = 0;
  std::uint64_t bus_off = 0;
  std::uint64_t error_passive = 0;

  BusStatistics& operator+=(const BusStatistics& other) noexcept {
    frames_received += other.frames_received;
    frames_sent += other.frames_sent;
    receive_dropped += other.receive_dropped;
    send_failed += other.send_failed;
    error_frames += other.error_frames;
    bus_off += other.bus_off;
    error_passive += other.error_passive;
    return *this;
  }
};

/// One set for each bus.
class BusCounters {
 public:
  BusStatistics& operator[](std::size_t bus) noexcept { return of_[bus]; }
  const BusStatistics& operator[](std::size_t bus) const noexcept { return of_[bus]; }
  BusStatistics total() const noexcept {
    BusStatistics total;
    for (const BusStatistics& one : of_)
      total += one;
    return total;
  }

 private:
  std::array<BusStatistics, kMaxBuses> of_{};
};

/// One bus, or several behind one object: then Frame::bus says on which of them a frame travels.
class Bus {
 public:
  virtual ~Bus() = default;

  /// To be called once, right before the first tick: what a live bus gathered while the loop was being set up
  /// is neither read nor counted.
  virtual void discardPending() noexcept {}

  /// Takes all frames that have arrived, oldest first, up to frames.size(); returns how many. Never waits.
  /// `now_ns` is the loop clock at the start of the tick.
  virtual std::size_t receive(std::span<Frame> frames, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING = 0;

  /// Queues one frame; never waits. On success fills in the frame's stamps.
  virtual SendResult send(Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING = 0;

  /// True while the controller is off the bus or the interface is down; of several, of any.
  virtual bool down() const noexcept = 0;

  /// Those of which that is true.
  virtual BusSet downBuses() const noexcept { return down() ? busBit(0) : BusSet{0}; }

  /// True when a finite source (a replayed log) has nothing more to give.
  virtual bool exhausted() const noexcept { return false; }

  /// Of all together, and of one.
  virtual BusStatistics statistics() const noexcept = 0;
  virtual BusStatistics statisticsOf(std::size_t /*bus*/) const noexcept { return statistics(); }
};

}  // namespace patella::can
