// The in-process rig in wall time on a thread of its own, as independent of the loop as a real one.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "core/spsc_ring.hpp"
#include "drivers/can/bus.hpp"
#include "drivers/can/error_monitor.hpp"
#include "drivers/clock/clock.hpp"
#include "sim/rig.hpp"

namespace patella::sim {

/// Runs a rig at its sensor period and is the loop's bus to it. Frames cross through lock-free rings: the
/// loop's side neither waits nor allocates, and only one loop thread may use it. A command acts from the
/// instant at which it was sent, unless the rig has lived past that already: then from the rig's instant.
class RigThread final : public can::Bus {
 public:
  /// Both must outlive this. `rig` belongs to the thread from start() until stop() has returned. With
  /// `priority` above 0 the thread asks for SCHED_FIFO, so that the rig is as punctual as the loop; where it
  /// is refused, it runs on.
  RigThread(Rig& rig, Clock& clock, int priority = 0);
  ~RigThread() override { stop(); }
  RigThread(const RigThread&) = delete;
  RigThread& operator=(const RigThread&) = delete;

  /// Begins at the next whole period of the clock, as a rig that is synchronised to it does; time that passed
  /// between stop() and another start() is made up for. Throws std::system_error when no thread can be had.
  void start();
  /// Returns when the thread has ended; harmless when it does not run.
  void stop() noexcept;

  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  /// kQueueFull when the rig has fallen behind by as many frames as the ring holds.
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  /// True while the thread does not run, or the rig's script says so.
  bool down() const noexcept override { return downBuses() != 0; }
  can::BusSet downBuses() const noexcept override {
    const bool running = running_.load(std::memory_order_relaxed);
    return static_cast<can::BusSet>(running ? errors_.wasOff() | rig_.interfacesDown() : can::kAllBuses);
  }
  can::BusStatistics statistics() const noexcept override;
  can::BusStatistics statisticsOf(std::size_t bus) const noexcept override { return statistics_[bus]; }

 private:
  void run() noexcept;

  Rig& rig_;
  Clock& clock_;
  int priority_;
  std::int64_t wall_offset_ns_;
  SpscRing<can::Frame> to_loop_;
  SpscRing<can::Frame> to_rig_;
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> running_{false};
  can::BusCounters statistics_;  // the loop thread's
  can::ErrorMonitor errors_;     // likewise
  std::thread thread_;
};

}  // namespace patella::sim
