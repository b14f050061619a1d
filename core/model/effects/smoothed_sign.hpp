// The sign of a velocity as friction takes it: smoothed, so that an integrator can step over a reversal.
#pragma once

#include <cmath>

#include "core/model/effect.hpp"

namespace patella::model {

/// −1…1, 76 % of ±1 at `smoothing_rad_s`.
inline double smoothedSign(double velocity_rad_s, double smoothing_rad_s) noexcept {
  return std::tanh(velocity_rad_s / smoothing_rad_s);
}

/// Chosen well below the velocities of interest and well above the noise of velocity.
inline constexpr EffectParameter kSmoothingVelocity{
    "smoothing_velocity_rad_s", "velocity at which 76 % of the level is reached", 1e-5, 1.0, 0.01, false};

}  // namespace patella::model
