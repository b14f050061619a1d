// An ODrive axis that speaks CANSimple, with a motor that drives its joint directly.
#pragma once

#include "sim/field_drive.hpp"

namespace patella::sim {

/// Identifier = node << 5 | command; all numbers little-endian. Heartbeat 01h: error u32, state u8, result
/// u8, trajectory u8. Set axis state 07h: u32, 8 closed loop, 1 idle. Encoder estimates 09h: turns and
/// turns/s, float32. Input torque 0Eh: N·m, float32. Temperature 15h: inverter and motor, °C, float32. Clear
/// errors 18h. Torques 1Ch: target and estimate, N·m, float32. Out of commands in closed loop it falls idle
/// with the error of its watchdog, and enters only once errors are cleared.
class Odrive final : public FieldDrive {
 public:
  explicit Odrive(const FieldDriveOptions& options) : FieldDrive(options) {}

 private:
  bool hear(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
            FrameSink& replies) noexcept override;
  void report(const JointReading& joint, std::int64_t now_ns, FrameSink& frames) noexcept override;
  void starved() noexcept override;
  void forget() noexcept override;

  can::Frame blank(unsigned command, int length) const noexcept;

  std::uint32_t error_ = 0;
  float target_Nm_ = 0.0F;
  std::int64_t next_heartbeat_ns_ = 0;
};

}  // namespace patella::sim
