// Share of the sensors in the torque that a model leaves.
#pragma once

#include <span>
#include <vector>

#include "core/model/mechanism.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// rms of each joint's sensor noise below `band_Hz`, N·m: the torque's own, and the encoders', whose second
/// derivative moves the mechanism's inertia. Each signal's noise is what lies in its quietest octave above
/// twice the band, where no motion is, as if it were white; 0 where the recording ends below that.
std::vector<double> sensorNoise_Nm(std::span<const Recording> recordings, const model::Mechanism& mechanism,
                                   double band_Hz);

}  // namespace patella::diagnose
