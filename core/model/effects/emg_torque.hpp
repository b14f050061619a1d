#pragma once

#include "core/model/effects/delay_line.hpp"
#include "core/model/effects/joint_effect.hpp"
#include "core/model/effects/memory_time.hpp"

namespace patella::model {

/// Torque of a muscle whose EMG is measured: in proportion to its activation, late by the electromechanical
/// delay.
class EmgTorque final : public JointEffect<3> {
 public:
  static const EffectDescriptor kDescriptor;

  /// Throws std::invalid_argument where the channel is no whole number.
  EmgTorque(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  void advance(const EffectInput& input, double dt_s) noexcept override;
  void reset(const EffectInput& input) noexcept override;

 private:
  double activation(const EffectInput& input) const noexcept { return input.activation[channel_]; }

  std::size_t channel_;  ///< from 0
  DelayLine<150> activation_;
  MemoryTime time_;
};

}  // namespace patella::model
