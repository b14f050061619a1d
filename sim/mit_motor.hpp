// An actuator in MIT mode: AK80 and its relatives.
#pragma once

#include <array>

#include "sim/field_drive.hpp"

namespace patella::sim {

/// Command, 8 bytes, most significant bits first: position 16 bits, velocity 12, stiffness 12, damping 12,
/// torque 12, each spread over its range; torque = stiffness·(p − q) + damping·(v − dq) + t. Seven bytes of
/// FF and FC enter, FD leave. It answers each of them, and says nothing otherwise: motor, position 16 bits,
/// velocity 12, torque 12, temperature, error. Nothing tells whether it has entered. Out of commands
/// it gives no torque until the next one. Layout as in the firmware of the MIT mini cheetah's actuator and in
/// libraries for the AK series; temperature and error are those of newer ones.
class MitMotor final : public FieldDrive {
 public:
  explicit MitMotor(const FieldDriveOptions& options) : FieldDrive(options) {}

 private:
  bool hear(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
            FrameSink& replies) noexcept override;
  void report(const JointReading&, std::int64_t, FrameSink&) noexcept override {}
  void starved() noexcept override {}
  void forget() noexcept override {}

  void reply(const JointReading& joint, FrameSink& replies) const noexcept;
};

}  // namespace patella::sim
