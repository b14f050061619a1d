#pragma once

#include "core/model/effects/joint_effect.hpp"
#include "core/model/effects/memory_time.hpp"

namespace patella::model {

/// The drive's torque follows its command through a first-order low-pass: current loop, or a compliant belt.
/// Exact for a command that is held, or linear, from sample to sample. Where lag and delay are both given,
/// each acts on the command by itself, which is their succession to first order.
class ActuatorLag final : public JointEffect<1> {
 public:
  static const EffectDescriptor kDescriptor;

  ActuatorLag(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  DriveLateness lateness() const noexcept override { return {.delay_s = 0.0, .lag_s = parameter(0)}; }
  void advance(const EffectInput& input, double dt_s) noexcept override;
  void reset(const EffectInput& input) noexcept override;

 private:
  double lagged(const EffectInput& input, double dt_s) const noexcept;

  double command_Nm_ = 0.0;
  double lagged_Nm_ = 0.0;
  MemoryTime time_;
};

}  // namespace patella::model
