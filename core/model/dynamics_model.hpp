// Mechanism plus effects: the model that the loop loads, evaluated once a tick.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/model/effect.hpp"
#include "core/model/mechanism.hpp"

namespace patella::model {

/// The known terms of (7)–(8) at one state:  ddq = f + inverse_inertia · tau + f_u.
struct ModelTerms {
  JointMatrix inertia;          ///< I + ΣΔI, kg·m²
  JointMatrix inverse_inertia;  ///< its inverse
  JointVector bias_Nm;          ///< C dq + K − Σ effect torque: what tau must balance at zero acceleration
  JointVector drive_Nm;         ///< of the Σ effect torque, that of effects of the drive
  JointVector f;                ///< −inverse_inertia · bias, rad/s²  (paper (8), corrected)
};

class DynamicsModel {
 public:
  /// Takes ownership; every effect must have been made for this mechanism. Throws std::invalid_argument when
  /// the mechanism or an effect is null.
  DynamicsModel(std::unique_ptr<Mechanism> mechanism, std::vector<std::unique_ptr<Effect>> effects);

  int joints() const noexcept { return mechanism_->joints(); }
  const Mechanism& mechanism() const noexcept { return *mechanism_; }
  std::span<const std::unique_ptr<Effect>> effects() const noexcept { return effects_; }

  /// Of each joint's drive: what all its effects add up to.
  std::array<DriveLateness, kMaxJoints> driveLateness() const noexcept;

  ModelTerms evaluate(const EffectInput& input) const noexcept PATELLA_NONBLOCKING;
  /// Torque that produces ddq, N·m.
  JointVector inverseDynamics(const EffectInput& input,
                              const JointVector& ddq) const noexcept PATELLA_NONBLOCKING;
  void advance(const EffectInput& input, double dt_s) noexcept PATELLA_NONBLOCKING;
  void reset(const EffectInput& input) noexcept PATELLA_NONBLOCKING;

 private:
  std::unique_ptr<Mechanism> mechanism_;
  std::vector<std::unique_ptr<Effect>> effects_;
};

}  // namespace patella::model
