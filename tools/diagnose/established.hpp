// What was found is kept as far as its parameters say anything.
#pragma once

#include <string>
#include <vector>

#include "tools/diagnose/model_fit.hpp"
#include "tools/diagnose/selection.hpp"

namespace patella::diagnose {

/// Covariance of a fit's parameters: the larger of what the noise makes of them and what leaving out parts of
/// the recording does.
Eigen::MatrixXd widerCovariance(const Dataset& data, const ModelFit& fit, int replicates, std::uint64_t seed);

/// Drops, one by one, effects that are not established: one number whose 95 % interval holds zero, beside
/// other findings; or one of which no parameter is known to within its tenfold. Parts of a free function
/// (freeFunctions()) stay. Returns the labels of what was dropped.
std::vector<std::string> dropWhatIsNotEstablished(ModelFitter& fitter, Selection& selection, int replicates,
                                                  std::uint64_t seed);

}  // namespace patella::diagnose
