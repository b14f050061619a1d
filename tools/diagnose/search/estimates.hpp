// A fit's estimates of an effect's parameters.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Standard deviations from the middle of a 95 % interval to its ends.
inline constexpr double kDeviations95 = 1.959964;

/// Covariance of a fit's parameters: the larger of what the noise makes of them and what leaving out parts of
/// the recording does.
Eigen::MatrixXd widerCovariance(const Dataset& data, const ModelFit& fit, int replicates, std::uint64_t seed);

/// The covariance with what a rugged objective hides: curvature says nothing of which of its neighbouring
/// valleys is the lowest by chance.
Eigen::MatrixXd withBumps(Eigen::MatrixXd covariance, const ModelFit& fit);

/// Derivatives of an effect's parameters (rows, in the order of its descriptor) by c and ν of its term. The
/// covariance says how far a step may go.
Eigen::MatrixXd parameterSlopes(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t term);

/// Estimated parameters of a term with 95 % intervals, by linear propagation of the fit's covariance, to
/// their logarithms where they are known up to factors. What a rugged objective depends on is not known
/// better than its bumps are wide.
std::vector<ParameterEstimate> estimates(const ModelFit& fit, const Eigen::MatrixXd& covariance,
                                         std::size_t term);

/// The mechanism's parameters before and after the fit.
std::vector<RefittedParameter> refittedParameters(const ModelFitter& fitter, const ModelFit& fit,
                                                  const Eigen::MatrixXd& covariance);

}  // namespace patella::diagnose
