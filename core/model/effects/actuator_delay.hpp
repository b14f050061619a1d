#pragma once

#include "core/model/effects/delay_line.hpp"
#include "core/model/effects/joint_effect.hpp"
#include "core/model/effects/memory_time.hpp"

namespace patella::model {

/// The drive's torque comes late: bus, drive electronics. Exact for a command that is linear from sample to
/// sample, and to 0.1 ms for one that is held.
class ActuatorDelay final : public JointEffect<1> {
 public:
  static const EffectDescriptor kDescriptor;

  ActuatorDelay(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  DriveLateness lateness() const noexcept override { return {.delay_s = parameter(0)}; }
  void advance(const EffectInput& input, double dt_s) noexcept override;
  void reset(const EffectInput& input) noexcept override;

 private:
  DelayLine<50> command_Nm_;
  MemoryTime time_;
};

}  // namespace patella::model
