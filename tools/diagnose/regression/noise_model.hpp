// The residual when a model explains all it can. Two views of it serve two ends: a mild weighting, under
// which a fit stays close to the least error in torque even where the model is wrong, and the full
// autoregressive process, from which chance is drawn.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/types.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// An autoregression for each joint over the blocks of a dataset: e_t = Σ a_k e_(t−k) + innovation.
struct Autoregression {
  int order = 0;
  std::array<Eigen::VectorXd, kMaxJoints> coefficients;

  /// Conditional least squares (Lütkepohl, New Introduction to Multiple Time Series Analysis, 3.2), joint by
  /// joint, as if white noise of `white_share` times the residual's variance were in it.
  static Autoregression fit(const Dataset& data, const Eigen::VectorXd& residual, int order,
                            double white_share);
  /// Rows that are left of one joint: each block loses its first `order`.
  Eigen::Index rows(const Dataset& data) const;
  /// Innovations of a column of one joint's rows.
  Eigen::VectorXd innovationsOf(const Dataset& data, int joint,
                                const Eigen::Ref<const Eigen::VectorXd>& column) const;
  /// Innovations of a column, one joint after the other.
  Eigen::VectorXd innovations(const Dataset& data, const Eigen::Ref<const Eigen::VectorXd>& column) const;
  /// The transposed map, of rows as innovations() gives them to a Column.
  Eigen::VectorXd transposed(const Dataset& data, const Eigen::VectorXd& innovations) const;
};

/// Filter and scale under which squared errors are summed.
class Weighting {
 public:
  /// The dataset must outlive it.
  Weighting(const Dataset& data, const Eigen::VectorXd& residual);
  /// The same filter, scaled to another residual.
  Weighting rescaled(const Eigen::VectorXd& residual) const;
  /// The same filter but on these joints, on which it is that of the residual; scaled to it.
  Weighting refiltered(const Eigen::VectorXd& residual, std::span<const int> joints) const;
  /// The same filter and scale, with the joints' correlation left in; so are those that rescaled() makes of
  /// it.
  Weighting jointByJoint() const;
  /// Largest correlation between two joints of what it was scaled to, without its sign.
  double correlation() const;

  int joints() const noexcept { return data_->joints(); }
  /// Number of one joint's rows.
  Eigen::Index rows() const noexcept { return rows_; }
  /// Columns in units of the residual's weighted standard deviation, the joints' correlation taken out.
  Eigen::MatrixXd apply(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// The first half of it: each joint filtered alone.
  Eigen::MatrixXd filtered(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// Its rows of one joint.
  Eigen::MatrixXd filteredOf(int joint, const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// The transposed second half: products of what filtered() gives with these rows are those of what apply()
  /// gives with the given ones.
  Eigen::MatrixXd gathered(const Eigen::Ref<const Eigen::MatrixXd>& weighted) const;
  /// Inverse covariance of the filtered joints, under which apply() makes products.
  Eigen::MatrixXd precision() const { return inverse_root_.transpose() * inverse_root_; }
  /// The transposed map, back to Columns.
  Eigen::MatrixXd transposed(const Eigen::Ref<const Eigen::MatrixXd>& weighted) const;
  /// rows · log det of the weighted residual's covariance: what a fit makes small.
  double objective(const Eigen::VectorXd& residual) const;

 private:
  void scaleTo(const Eigen::VectorXd& residual);
  Eigen::MatrixXd covariance(const Eigen::VectorXd& residual) const;

  const Dataset* data_;
  Autoregression filter_;
  Eigen::Index rows_;
  bool apart_ = false;  ///< the joints' correlation is left in
  /// U⁻¹ of the weighted covariance U Uᵀ, U an upper triangle: a joint's rows are made of those of the joints
  /// after it, which of the parameters of a chain's links know its last ones only.
  Eigen::MatrixXd inverse_root_;
};

/// Draws residuals like the one it was fitted to.
class NoiseProcess {
 public:
  NoiseProcess(const Dataset& data, const Eigen::VectorXd& residual);

  int order() const noexcept { return process_.order; }
  /// Innovations drawn with replacement, the joints together, run through the autoregression.
  Eigen::VectorXd draw(std::mt19937_64& random) const;
  /// Variance of the product of a Column with a draw.
  double variance(const Eigen::Ref<const Eigen::VectorXd>& column) const;

 private:
  const Dataset* data_;
  Autoregression process_;
  Eigen::MatrixXd innovations_;  ///< rows x joints
};

}  // namespace patella::diagnose
