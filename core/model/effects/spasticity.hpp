#pragma once

#include "core/model/effects/delay_line.hpp"
#include "core/model/effects/joint_effect.hpp"
#include "core/model/effects/memory_time.hpp"

namespace patella::model {

/// The stretch reflex of a spastic muscle: beyond a threshold of velocity it resists being stretched, late by
/// the reflex's way through the spinal cord.
class Spasticity final : public JointEffect<4> {
 public:
  static const EffectDescriptor kDescriptor;

  /// Throws std::invalid_argument where the direction is neither -1 nor 1.
  Spasticity(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  void advance(const EffectInput& input, double dt_s) noexcept override;
  void reset(const EffectInput& input) noexcept override;

 private:
  DelayLine<100> velocity_rad_s_;
  MemoryTime time_;
};

}  // namespace patella::model
