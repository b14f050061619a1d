// An observer with a low-pass behind it: what makes an estimate of the sampler's kind usable in noise.
#pragma once

#include <memory>
#include <vector>

#include "core/estimation/observer.hpp"
#include "core/signal/biquad.hpp"

namespace patella::estimation {

/// Second-order Butterworth on each joint. It delays the estimate by about √2 / (2π cutoff).
class LowPassObserver final : public Observer {
 public:
  /// Samples come at rate_Hz; where one is missing the filter sees the next in its place. Throws
  /// std::invalid_argument when there is no observer or a cutoff is not between 0 and half the rate.
  LowPassObserver(std::unique_ptr<Observer> observer, const PerJoint& cutoff_Hz, double rate_Hz);

  void reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;
  JointVector update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING override;

 private:
  std::unique_ptr<Observer> observer_;
  std::vector<signal::BiquadCascade> filters_;
};

}  // namespace patella::estimation
