// A motor behind a spring, with play or without: what transmission_elasticity and backlash have in common.
#pragma once

#include <array>
#include <cstddef>

#include "core/model/effect.hpp"
#include "core/model/effects/memory_time.hpp"

namespace patella::model {

struct TwoMassParameters {
  double stiffness_Nm_rad = 0.0;     ///< > 0
  double damping_Nms_rad = 0.0;      ///< while the spring is in contact
  double rotor_inertia_kg_m2 = 0.0;  ///< > 0, seen at the joint
  double gap_rad = 0.0;              ///< play from contact to contact
  bool pulls = true;                 ///< a spring; otherwise two contacts, which can only push
};

/// One end of the spring.
struct TwoMassSide {
  double angle_rad = 0.0;
  double rate_rad_s = 0.0;
};

/// What happens to the motor along a step: the link's angle from the step's begin, the link's rate, and the
/// drive's torque.
struct TwoMassCourse {
  double way_rad = 0.0;    ///< of the link
  double start_rad = 0.0;  ///< by which the rate at the begin would take it farther in the step …
  double end_rad = 0.0;    ///< … and that at the end less far
  double rate_rad_s = 0.0, rate_gain_rad_s = 0.0;
  double drive_Nm = 0.0, drive_gain_Nm = 0.0;
};

/// The link's motion is measured, the motor's is the memory: rotor ddθ = drive torque − T, with T transmitted
/// to the link. Along a step the link moves on the cubic through the angles and rates at its ends.
///
/// Steps h of 25 to 500 µs, 0.15/ω where that lies between, by the weighted implicit rule with weight 0.51:
/// unconditionally stable, its damping ratio of 0.01 ω h is at most 0.15 % for resonances up to 6000 rad/s.
/// The spring's law is piecewise linear, so each step is solved in closed form. Without play all of them
/// together are a linear map, which is worked out once for steps of one length. The torque depends on the
/// rate of the samples, at 250 Hz and more, by less than 3 % of its rms.
class TwoMass {
 public:
  TwoMass(int joint, const TwoMassParameters& parameters) noexcept;

  /// T less the drive's torque, N·m: what the transmission changes for the link.
  double torque(const EffectInput& input) const noexcept;
  void advance(const EffectInput& input, double dt_s) noexcept;
  /// The motor rests against the spring that carries the drive's torque, and moves with the link.
  void reset(const EffectInput& input) noexcept;

 private:
  static constexpr std::size_t kInputs = 9;  ///< the motor's state and the numbers of a course

  TwoMassSide linkOf(const EffectInput& input) const noexcept { return {input.q[joint_], input.dq[joint_]}; }
  TwoMassSide motorAfter(const EffectInput& input, double dt_s) const noexcept;
  /// By substeps; angles from the link's at the begin.
  TwoMassSide stepped(const TwoMassSide& motor, const TwoMassCourse& course, double dt_s) const noexcept;
  void learnStep(double dt_s) noexcept;

  int joint_;
  TwoMassParameters parameters_;
  double substep_s_;
  TwoMassSide motor_;
  TwoMassSide link_;
  double drive_Nm_ = 0.0;
  MemoryTime time_;
  double last_dt_s_ = 0.0;
  double learnt_dt_s_ = 0.0;  ///< length of the steps that `answers_` belongs to; 0: none yet
  std::array<TwoMassSide, kInputs> answers_{};  ///< motor after such a step, per unit of each input
};

}  // namespace patella::model
