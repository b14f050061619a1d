// The model's parameters adapted while the push is estimated, as a contender beside observers and network.
#pragma once

#include <cstdint>
#include <span>

#include "tools/studies/learning/adaptive_filter.hpp"
#include "tools/studies/learning/corrected.hpp"

namespace patella::study {

/// Parameters of the preset `physical` that may be wrong; friction of both joints may be, too.
enum class AdaptedBody : std::uint8_t {
  kShank,  ///< one number: by which share the shank's mass and inertia are larger
  kWhole,  ///< five: by which share each base parameter is larger
};

/// Change of the preset's base parameters for one of each number.
BodyDirections directionsOf(AdaptedBody body);

/// To be tuned by the rule of the observers: densities of the push and its corner. How wrong the model may
/// be, and how fast that changes, stays as AdaptiveSettings says: a few runs, each from the nominal model, do
/// not show it.
Method adaptiveMethod(AdaptedBody body);

/// `values`: densities of both components of the push, N/s^{3/2}, and its corner, Hz.
AdaptiveFilter makeAdaptiveFilter(AdaptedBody body, std::span<const double> values);

/// Passes a run through the filter, from the nominal model or, `keep`, with what the filter knows of it
/// already. Joint torques, as the observers' (corrected.hpp).
Delivered deliverAdaptive(AdaptiveFilter& filter, const Recording& recording, const ObservedRun& run,
                          bool keep, double horizon_s);

}  // namespace patella::study
