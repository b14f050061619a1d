// A fit's estimates of an effect's parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Standard deviations from the middle of a 95 % interval to its ends.
inline constexpr double kDeviations95 = 1.959964;

/// Covariance of a fit's parameters: the larger of what the noise makes of them and what leaving out parts of
/// the recording does.
Eigen::MatrixXd widerCovariance(const Dataset& data, const ModelFit& fit, int replicates, std::uint64_t seed);

/// The covariance, widened where a parameter's variance is less than a rest beyond noise allows. Such a rest
/// comes again wherever the motion does, so that more rows tell no more of it: it counts as asserted::kLooks
/// independent looks, however long the recording is. `rests`: joint by joint.
Eigen::MatrixXd withRest(const Eigen::MatrixXd& covariance, const Dataset& data, const ModelFit& fit,
                         std::span<const JointRest> rests);

/// The covariance with what a rugged objective hides: curvature says nothing of which of its neighbouring
/// valleys is the lowest by chance.
Eigen::MatrixXd withBumps(Eigen::MatrixXd covariance, const ModelFit& fit);

/// Derivatives of an effect's parameters (rows, in the order of its descriptor) by c and ν of its term. The
/// covariance says how far a step may go.
Eigen::MatrixXd parameterSlopes(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t term);

/// Half the 95 % interval of a torque over that torque, as rms values: of what the strengths of a term make
/// together whose logarithms are its parameters, or that EffectHome::told_by_torque says of. Each of them may
/// be unknown where slopes or a time constant make up for it, and the torque be known. Nothing for a term
/// without such strengths.
std::optional<double> torqueError(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t term);

/// Estimated parameters of a term with 95 % intervals, by linear propagation of the fit's covariance, to
/// their logarithms where they are known up to factors. What a rugged objective depends on is not known
/// better than its bumps are wide.
std::vector<ParameterEstimate> estimates(const ModelFit& fit, const Eigen::MatrixXd& covariance,
                                         std::size_t term);

/// The mechanism's parameters before and after the fit.
std::vector<RefittedParameter> refittedParameters(const ModelFitter& fitter, const ModelFit& fit,
                                                  const Eigen::MatrixXd& covariance);

}  // namespace patella::diagnose
