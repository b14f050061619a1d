// Forecast of a Kalman filter that estimates rates.
#pragma once

#include "tools/studies/learning/corrected.hpp"

namespace patella::study {

/// Whether the observer is a Kalman filter of constant rate.
bool knowsRate(const Tuned& observer, const Condition& condition);

/// Runs such a filter over what the run's front end saw and moves its state on by the horizon: posture by
/// velocity and acceleration, the disturbance by its rate. Joint torques.
Delivered predictConstantRate(const Recording& recording, const ObservedRun& run, const Tuned& tuned,
                              double horizon_s);

}  // namespace patella::study
