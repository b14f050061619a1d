// The unknown dynamics of a whole recording, each sample in the light of all others: targets for learning.
#pragma once

#include <span>
#include <vector>

#include "core/estimation/kalman_settings.hpp"
#include "core/estimation/observer.hpp"

namespace patella::estimation {

/// Fixed-interval smoother of Rauch, Tung and Striebel (1965) behind the extended Kalman filter. One estimate
/// a sample; without delay, as it looks both ways. The first sample resets the filter.
///
/// Offline: allocates about 2 kB a sample. `input.model` must be given and its effects must have no memory
/// that moves between samples, as all are evaluated as it stands. Throws std::invalid_argument when settings
/// are refused (kalman_settings.hpp), position is not to be estimated, or a sample lacks its model.
std::vector<UnknownDynamics> smoothUnknownDynamics(const KalmanSettings& settings,
                                                   std::span<const ObserverInput> samples);

}  // namespace patella::estimation
