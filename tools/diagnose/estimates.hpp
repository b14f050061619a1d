// What a fit says of an effect's parameters.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/diagnosis.hpp"
#include "tools/diagnose/model_fit.hpp"

namespace patella::diagnose {

/// Covariance of a fit's parameters: the larger of what the noise makes of them and what leaving out parts of
/// the recording does.
Eigen::MatrixXd widerCovariance(const Dataset& data, const ModelFit& fit, int replicates, std::uint64_t seed);

/// Estimated parameters of a term with 95 % intervals, by linear propagation of the fit's covariance, to
/// their logarithms where they are known up to factors. What a rugged objective depends on is not known
/// better than its bumps are wide.
std::vector<ParameterEstimate> estimates(const ModelFit& fit, const Eigen::MatrixXd& covariance,
                                         std::size_t term);

}  // namespace patella::diagnose
