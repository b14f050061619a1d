// The finite-time sampler as the paper prints it, for comparison.
#pragma once

#include "core/estimation/observer.hpp"
#include "core/estimation/sampler_parameters.hpp"

namespace patella::estimation {

/// (21)–(23) by explicit Euler, with psi^{p0/q0} read as sign(psi) |psi|^{p0/q0} and |f| joint by joint. Its
/// output chatters with |f| + delta, and it diverges from k_d dt = 2 on.
class PrintedSampler final : public Observer {
 public:
  /// Throws std::invalid_argument (sampler_parameters.hpp).
  explicit PrintedSampler(const SamplerParameters& parameters);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

 private:
  /// Right-hand side of (22) without the torque.
  JointVector correction(const JointVector& f) const noexcept;

  SamplerParameters parameters_;
  JointVector psi_;
  JointVector xi_;
  JointVector previous_correction_;
  JointMatrix previous_inverse_inertia_;
};

}  // namespace patella::estimation
