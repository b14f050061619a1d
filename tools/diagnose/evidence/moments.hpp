// What an inference needs of a dataset: products of columns, split by joint and frequency band. Its size
// depends on the number of columns, not on the length of the recordings.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose::evidence {

/// Columns are taken to frequencies by a discrete cosine transform of each stretch, whose even continuation
/// leaks less than the Fourier transform's jump. Noise that is stationary has independent coefficients there.
class Moments {
 public:
  explicit Moments(const Dataset& data);

  int joints() const noexcept { return static_cast<int>(count_.size()); }
  int bands() const noexcept { return static_cast<int>(edges_Hz_.size()) - 1; }
  /// Lower edge of each band and upper edge of the last, Hz.
  const std::vector<double>& edges_Hz() const noexcept { return edges_Hz_; }
  /// Coefficients of one joint in a band; 0 where the recordings are too short for any.
  double coefficients(int band) const noexcept { return count_.front()[static_cast<std::size_t>(band)]; }

  /// Sum over all bands.
  double coefficients() const noexcept;

  /// Appends columns (rows as Dataset::Column) and returns the index of the first.
  Eigen::Index append(const Eigen::Ref<const Eigen::MatrixXd>& columns);
  Eigen::Index columns() const noexcept { return columns_; }

  /// Products of all columns with all, over the coefficients of a joint in a band.
  Eigen::Ref<const Eigen::MatrixXd> products(int joint, int band) const {
    return products_[index(joint, band)].topLeftCorner(columns_, columns_);
  }
  /// Sum of squares of a column over the bands of a joint.
  double square(int joint, Eigen::Index column) const;

 private:
  std::size_t index(int joint, int band) const noexcept {
    return static_cast<std::size_t>(joint) * static_cast<std::size_t>(bands()) +
           static_cast<std::size_t>(band);
  }
  void layOut();
  void reserve(Eigen::Index columns);

  const Dataset* data_;
  std::vector<double> edges_Hz_;
  std::vector<std::vector<double>> count_;  ///< of each joint and band
  std::vector<Eigen::Index> place_;         ///< of each coefficient of all stretches; −1: above the band
  std::vector<Eigen::Index> first_;         ///< of each band among the kept coefficients, and their number
  std::vector<Eigen::MatrixXd> spectra_;    ///< of each joint: coefficients × columns
  std::vector<Eigen::MatrixXd> products_;
  Eigen::Index columns_ = 0;
};

}  // namespace patella::diagnose::evidence
