// The digital lines of a rig: emergency stop in, drive enable and heartbeat out.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/types.hpp"

namespace patella::gpio {

/// Outputs may be set from any thread: the watchdog and a dying process take the drive enable line down.
class Pins {
 public:
  virtual ~Pins() = default;

  /// True when the emergency stop is pressed at this moment, when it was pressed at any instant since the
  /// last call (edge seen by the kernel), or when the line cannot be read. The circuit is active low: a
  /// broken wire stops.
  virtual bool emergencyStop() noexcept PATELLA_NONBLOCKING = 0;
  /// True when the line took the level (or is not wired), false when the device refused.
  virtual bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING = 0;
  /// Toggled once a tick by the loop, watched by hardware. Returns as setDriveEnable does.
  virtual bool setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING = 0;
  /// Toggled by the watchdog thread for as long as it and the loop live; for hardware that watches both.
  virtual void setWatchdogHeartbeat(bool level) noexcept { static_cast<void>(level); }
};

/// Lines of a simulated rig: memory that tests and the in-process rig read and set.
class SimulatedPins final : public Pins {
 public:
  bool emergencyStop() noexcept PATELLA_NONBLOCKING override { return emergency_stop_; }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    drive_enable_.store(enabled, std::memory_order_relaxed);
    return true;
  }
  bool setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING override {
    heartbeat_edges_ += level != heartbeat_ ? 1U : 0U;
    heartbeat_ = level;
    return true;
  }
  void setWatchdogHeartbeat(bool level) noexcept override {
    watchdog_edges_.fetch_add(level != watchdog_heartbeat_ ? 1 : 0, std::memory_order_relaxed);
    watchdog_heartbeat_ = level;
  }

  void pressEmergencyStop(bool pressed) noexcept { emergency_stop_ = pressed; }
  bool driveEnable() const noexcept { return drive_enable_.load(std::memory_order_relaxed); }
  std::uint64_t heartbeatEdges() const noexcept { return heartbeat_edges_; }
  std::uint64_t watchdogEdges() const noexcept { return watchdog_edges_.load(std::memory_order_relaxed); }

 private:
  bool emergency_stop_ = false;
  std::atomic<bool> drive_enable_{false};
  bool watchdog_heartbeat_ = false;
  std::atomic<std::uint64_t> watchdog_edges_{0};
  bool heartbeat_ = false;
  std::uint64_t heartbeat_edges_ = 0;
};

}  // namespace patella::gpio
