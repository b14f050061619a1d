// Questions that a larger model must answer before it is believed, both fits linearised at their optimum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

/// Blocks of time of the bootstrap; a fold of the cross-validation is two of them, and so is a block of the
/// jackknife: seconds long in a recording of half a minute, so that a person's push is forgotten from one to
/// the next.
inline constexpr int kTimeBlocks = 20;

/// Normal equations of a linearised fit, block by block of time. Around the optimum the model is residual +
/// tangent·x with the prior pulling x to where its own residual vanishes.
struct BlockEquations {
  std::vector<Eigen::MatrixXd> gram;
  std::vector<Eigen::VectorXd> moment;
  std::vector<double> square;
  Eigen::MatrixXd prior;
  Eigen::VectorXd prior_moment;
  double prior_square = 0.0;

  BlockEquations(const ModelFit& fit, const Weighting& weighting, int blocks);
  /// From the products of the weighted tangent and the residual, its last column, with each other: one matrix
  /// for each block. Of the fit what is known beforehand is looked at only.
  BlockEquations(const ModelFit& fit, std::span<const Eigen::MatrixXd> products);
  /// Sums over blocks, each of which counts so many times.
  struct Sums {
    Eigen::MatrixXd gram;
    Eigen::VectorXd moment;
    double square = 0.0;
    /// Squared error at x.
    double error(const Eigen::VectorXd& x) const;
  };
  Sums sums(std::span<const double> weight) const;
  /// x of so many blocks, with what is known beforehand.
  Eigen::VectorXd solution(const Sums& sums) const;
  /// Squared distance of x from what is known.
  double priorError(const Eigen::VectorXd& x) const;
};

/// A smaller and a larger fit of the same rows, on blocks of time.
class Blockwise {
 public:
  Blockwise(const ModelFit& smaller, const ModelFit& larger);
  /// Both of kTimeBlocks.
  Blockwise(BlockEquations smaller, BlockEquations larger);

  /// Whether the larger fit is the better one on blocks that were not fitted: its gain in squared whitened
  /// error is positive by accepted::kCrossValidationErrors, or on all blocks but one at most. A block that
  /// alone shows what a parameter is, such as a motion's onset, cannot be foreseen from the others, and its
  /// loss, a linear extrapolation, says nothing.
  bool foreseen() const;
  /// Whether it gains more than `cost` in a share accepted::kLeastStability of block bootstraps.
  bool isStable(double cost, std::uint64_t seed) const;

 private:
  /// Falls that the larger model brings.
  struct Gain {
    double error = 0.0;  ///< of the squared error
    double prior = 0.0;  ///< of the squared distance from what is known
  };
  /// Parameters fitted to blocks with one weight and judged with another, or with the same.
  Gain gain(std::span<const double> fitted, std::span<const double> judged) const;
  Gain gain(std::span<const double> weight) const;

  BlockEquations without_;
  BlockEquations with_;
};

/// Covariance of a fit's parameters from leaving out one block of time after another (jackknife): it also
/// holds what the noise model does not know, such as an effect that is not quite of its equation's shape. So
/// wide that intervals of a normal distribution with it are those of Student's t for as many blocks.
Eigen::MatrixXd jackknifeCovariance(const ModelFit& fit);
/// The same of kTimeBlocks.
Eigen::MatrixXd jackknifeCovariance(const BlockEquations& blocks);

}  // namespace patella::diagnose
