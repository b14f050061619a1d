// Linear extended state observer of third order: f_u as one more state of the motion.
#pragma once

#include "core/estimation/observer.hpp"
#include "core/estimation/step_mean.hpp"

namespace patella::estimation {

/// A chain of three integrators that is driven by the known acceleration and corrected by what is measured:
///   with velocity:     dq, f_u and its rate, corrected by dq: follows a steady ramp of f_u without delay;
///   encoder only:      q, dq and f_u, corrected by q.
/// All three poles of the error lie at exp(−2π bandwidth dt), whatever the step. Which of the two it is, the
/// sample given to reset() decides. Source: Gao (2003), with the gains of the fading-memory polynomial filter
/// for an exact placement in discrete time.
class ExtendedStateObserver final : public Observer {
 public:
  /// Throws std::invalid_argument unless bandwidth_Hz is positive and finite.
  explicit ExtendedStateObserver(const PerJoint& bandwidth_Hz);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

 private:
  PerJoint bandwidth_Hz_;
  bool has_velocity_ = true;
  StepMean known_;
  JointVector first_;  ///< the measured one of the three
  JointVector second_;
  JointVector third_;
};

}  // namespace patella::estimation
