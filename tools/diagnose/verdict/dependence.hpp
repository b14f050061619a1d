// Variables on which a fit's residual depends, whatever the shape: evidence that something is missing which
// no effect of the library explains.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {

/// Tests piecewise linear functions of each joint's position, velocity, acceleration, of EMG activation, time
/// (at rest: of the order of the postures) and of some products, and the functions of addSuggested() and
/// changingStiffness(), for each joint's residual; family-wise by a bootstrap of the smallest p. The last are
/// a family of their own, which shares the level with the rest. Where joints leave much the same and nothing
/// is found, all is tested again joint by joint: what pulls at two joints alike passes for noise that they
/// share, beside which a function on one of them explains nothing. Returns those with a p below the level
/// that explain more than `least_Nm` (rms) on their joint, strongest first.
std::vector<Dependence> testDependence(const Dataset& data, const ModelFit& fit,
                                       std::span<const int> channels, std::span<const double> least_Nm,
                                       int replicates, double family_wise_p, std::uint64_t seed);

}  // namespace patella::diagnose
