// Products of filtered columns with each other, joint by joint. Under any precision P of the joints,
// W = P^½ after the filter, they give (W z)ᵀ(W z) without another look at the rows:
//   Σ_ik P_ik z_iᵀ z_k,   z_i the filtered rows of joint i.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/regression/noise_model.hpp"

namespace patella::diagnose {

class FilteredProducts {
 public:
  /// Of columns that stay, under the weighting's filter.
  FilteredProducts(const Weighting& weighting, const Eigen::MatrixXd& columns);

  /// The same with further columns behind them; those that stay are not looked at again.
  FilteredProducts with(const Weighting& weighting, const Eigen::MatrixXd& further) const;
  /// The same under a weighting whose filter differs on these joints only. `columns`: all of them.
  FilteredProducts refiltered(const Weighting& weighting, const Eigen::MatrixXd& columns,
                              std::span<const int> joints) const;

  /// Of all columns with each other, under the joints' precision.
  Eigen::MatrixXd gram(const Eigen::MatrixXd& precision) const;

 private:
  /// Columns that are not zero on a joint.
  struct Columns {
    std::vector<Eigen::Index> place;
    Eigen::MatrixXd rows;
  };
  using Product = std::shared_ptr<const Eigen::MatrixXd>;

  Eigen::Index joints() const noexcept { return static_cast<Eigen::Index>(filtered_.size()); }
  std::size_t pair(Eigen::Index i, Eigen::Index k) const noexcept;
  Columns feltOf(Eigen::Index joint, Eigen::Index first) const;
  /// z_iᵀ z_k, and its transpose where i ≠ k: of the staying columns with each other.
  Product ofStaying(Eigen::Index i, Eigen::Index k) const;
  /// The same of all columns with the further ones.
  Product ofFurther(Eigen::Index i, Eigen::Index k) const;

  Eigen::Index staying_;
  std::vector<Product> filtered_;  ///< rows of each joint
  std::vector<Product> stay_;      ///< of each pair
  std::vector<Product> further_;   ///< of each pair
};

}  // namespace patella::diagnose
