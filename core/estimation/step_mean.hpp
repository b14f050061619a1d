// The model's mean over the step between two samples: the part that every observer shares.
#pragma once

#include "core/estimation/observer.hpp"

namespace patella::estimation {

/// Averages the known acceleration over each step by the trapezoidal rule, the torque being held over it:
///   ½ (f_{k−1} + f_k) + ½ (I⁻¹_{k−1} + I⁻¹_k) tau_k.
/// With the terms of one end only, the estimate would be wrong by their change over a step.
class StepMean {
 public:
  /// The step begins at this sample.
  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
    f_ = input.terms.f;
    inverse_inertia_ = input.terms.inverse_inertia;
  }

  /// Known acceleration, rad/s², of the step that ends at this sample, where the next one begins.
  JointVector advance(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
    const JointVector mean =
        0.5 * (f_ + input.terms.f + (inverse_inertia_ + input.terms.inverse_inertia) * input.torque_Nm);
    reset(input);
    return mean;
  }

 private:
  JointVector f_;
  JointMatrix inverse_inertia_;
};

}  // namespace patella::estimation
