// Columns under the filters of a weighting, with their products joint by joint.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/noise_model.hpp"

namespace patella::diagnose {

/// Normal equations of many fits to the same columns. A covariance of the joints' noise is no part of what is
/// kept, and another filter on one joint changes the products of that joint alone.
class FilteredColumns {
 public:
  /// The dataset must outlive it.
  FilteredColumns(const Dataset& data, const Weighting& filters, const Eigen::MatrixXd& columns);

  /// With the filters of another weighting on these joints. On all others its filters are the same, and the
  /// columns too; more of them may follow, which are zero there.
  FilteredColumns changed(const Weighting& filters, const Eigen::MatrixXd& columns,
                          std::span<const int> joints) const;

  const Weighting& filters() const noexcept { return filters_; }
  /// Weighting::apply(columns)ᵀ Weighting::apply(columns), of a weighting with these filters.
  Eigen::MatrixXd gram(const Weighting& scaled) const;
  /// Weighting::apply(columns)ᵀ Weighting::apply(column).
  Eigen::VectorXd products(const Weighting& scaled, const Eigen::VectorXd& column) const;

 private:
  /// Filtered columns on the rows of a joint, without those that are zero there.
  struct OfJoint {
    std::vector<Eigen::Index> felt;
    Eigen::MatrixXd rows;
  };
  using Product = std::shared_ptr<const Eigen::MatrixXd>;

  void filter(int joint, const Eigen::MatrixXd& columns);
  void multiply(int joint);
  Product& productOf(int joint, int other) {
    return products_[static_cast<std::size_t>(joint * joints() + other)];
  }
  const Product& productOf(int joint, int other) const {
    return products_[static_cast<std::size_t>(joint * joints() + other)];
  }
  int joints() const noexcept { return data_->joints(); }

  const Dataset* data_;
  Weighting filters_;
  Eigen::Index count_;  ///< columns
  std::vector<std::shared_ptr<const OfJoint>> of_;
  std::vector<Product> products_;  ///< of a joint with those from itself on
};

}  // namespace patella::diagnose
