#pragma once

#include "core/model/effects/joint_effect.hpp"
#include "core/model/effects/two_mass.hpp"

namespace patella::model {

/// Play in the gear: the motor drives the link only where it has crossed the gap. What the contact is like is
/// a choice, as recordings of the link hardly show it. The encoder is on the link; the rotor's inertia is
/// this effect's, none of the mechanism's.
class Backlash final : public JointEffect<4> {
 public:
  static const EffectDescriptor kDescriptor;

  Backlash(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  void advance(const EffectInput& input, double dt_s) noexcept override { drive_.advance(input, dt_s); }
  void reset(const EffectInput& input) noexcept override { drive_.reset(input); }

 private:
  TwoMass drive_;
};

}  // namespace patella::model
