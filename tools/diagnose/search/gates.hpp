// Questions that a larger model must answer before it is believed, both fits linearised at their optimum.
#pragma once

#include <cstdint>

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// Gates that a step of the search has to pass; one is left out to measure its worth.
struct Gates {
  bool share = true;             ///< a share of the residual that anyone would miss
  bool chance = true;            ///< family-wise p of a parametric bootstrap
  bool cross_validation = true;  ///< gain on folds that were not fitted
  bool stability = true;         ///< gain on most block bootstraps
  bool heldout = true;           ///< smaller error on the held-out part
  bool rest = true;              ///< asserted only with more torque than what nothing explains
};

/// Blocked cross-validation: mean and standard error over blocks of the fall in squared whitened error on the
/// block that a fit has not seen.
struct CrossValidation {
  double gain = 0.0;
  double standard_error = 0.0;
  /// All blocks but one at most gain. A block that alone shows what a parameter is, such as a motion's onset,
  /// cannot be foreseen from the others, and its loss, a linear extrapolation, says nothing.
  bool almost_everywhere = false;
};
CrossValidation crossValidate(const ModelFit& smaller, const ModelFit& larger);

/// Share of block bootstraps in which the larger model gains more than `cost`.
double stability(const ModelFit& smaller, const ModelFit& larger, double cost, std::uint64_t seed);

/// Covariance of a fit's parameters from leaving out one block of time after another (jackknife): it also
/// holds what the noise model does not know, such as an effect that is not quite of its equation's shape. So
/// wide that intervals of a normal distribution with it are those of Student's t for as many blocks.
Eigen::MatrixXd jackknifeCovariance(const ModelFit& fit);

}  // namespace patella::diagnose
