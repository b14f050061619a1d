#pragma once

#include "core/model/effects/joint_effect.hpp"
#include "core/model/effects/two_mass.hpp"

namespace patella::model {

/// The motor drives the link through a spring: harmonic drive, cable, series elastic actuator. The encoder is
/// on the link; the rotor's inertia is this effect's, none of the mechanism's.
class TransmissionElasticity final : public JointEffect<3> {
 public:
  static const EffectDescriptor kDescriptor;

  TransmissionElasticity(int joint, const Mechanism& mechanism, std::span<const double> parameters);

  const EffectDescriptor& descriptor() const noexcept override { return kDescriptor; }
  JointVector torque(const EffectInput& input) const noexcept override;
  void advance(const EffectInput& input, double dt_s) noexcept override { drive_.advance(input, dt_s); }
  void reset(const EffectInput& input) noexcept override { drive_.reset(input); }

 private:
  TwoMass drive_;
};

}  // namespace patella::model
