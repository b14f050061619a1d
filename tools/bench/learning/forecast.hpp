// What a Kalman filter that knows rates says of the near future.
#pragma once

#include "tools/bench/learning/corrected.hpp"

namespace patella::bench {

/// Runs the filter that the observer is, which must be of constant rate, and moves its state on by the
/// horizon: posture by velocity and acceleration, the disturbance by its rate. Joint torques.
Delivered predictConstantRate(const Recording& recording, const ObservedRun& run, const Tuned& observer,
                              double horizon_s);

}  // namespace patella::bench
