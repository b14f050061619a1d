// Keeps the effects whose parameters are established.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// Drops, one by one, effects that are not established: one number whose 95 % interval holds zero, beside
/// other findings; or one of which no parameter is known to within its tenfold. Parts of a free function
/// (freeFunctions()) stay. Returns the labels of what was dropped.
std::vector<std::string> dropWhatIsNotEstablished(ModelFitter& fitter, Selection& selection, int replicates,
                                                  std::uint64_t seed);

}  // namespace patella::diagnose
