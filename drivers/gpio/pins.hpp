// The digital lines of a rig: emergency stop in, drive enable and heartbeat out.
#pragma once

#include <cstdint>

#include "core/types.hpp"

namespace patella::gpio {

class Pins {
 public:
  virtual ~Pins() = default;

  /// True when the emergency stop is pressed at this moment, when it was pressed at any instant since the
  /// last call (edge seen by the kernel), or when the line cannot be read. The circuit is active low: a
  /// broken wire stops.
  virtual bool emergencyStop() noexcept PATELLA_NONBLOCKING = 0;
  /// True when the line took the level (or is not wired), false when the device refused.
  virtual bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING = 0;
  /// Toggled once a tick by the loop, watched by hardware.
  virtual void setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING = 0;
  /// Calls that the device refused.
  virtual std::uint64_t errors() const noexcept = 0;
};

/// Lines of a simulated rig: memory that tests and the in-process rig read and set.
class SimulatedPins final : public Pins {
 public:
  bool emergencyStop() noexcept PATELLA_NONBLOCKING override { return emergency_stop_; }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    drive_enable_ = enabled;
    return true;
  }
  void setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING override {
    heartbeat_edges_ += level != heartbeat_ ? 1U : 0U;
    heartbeat_ = level;
  }
  std::uint64_t errors() const noexcept override { return 0; }

  void pressEmergencyStop(bool pressed) noexcept { emergency_stop_ = pressed; }
  bool driveEnable() const noexcept { return drive_enable_; }
  std::uint64_t heartbeatEdges() const noexcept { return heartbeat_edges_; }

 private:
  bool emergency_stop_ = false;
  bool drive_enable_ = false;
  bool heartbeat_ = false;
  std::uint64_t heartbeat_edges_ = 0;
};

}  // namespace patella::gpio
