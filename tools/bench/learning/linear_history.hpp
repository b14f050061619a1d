// What a network has to beat: a linear function of the features of now and of some while ago.
#pragma once

#include <span>
#include <vector>

#include "core/types.hpp"
#include "tools/train/sequence.hpp"

namespace patella::bench {

/// Ridge regression on normalised features of the last 0.36 s, at ten lags that grow apart.
class LinearHistory {
 public:
  LinearHistory(std::span<const train::Sequence> sequences, const network::NetworkWeights& frame);

  void reset();
  /// Features in physical units, one step; what targetOf() is of.
  JointVector step(std::span<const double> features);

 private:
  Eigen::RowVectorXd regressors() const;
  void push(const Eigen::RowVectorXd& features);

  network::NetworkWeights frame_;
  Eigen::MatrixXd coefficients_;          ///< regressors x outputs, of normalised targets
  std::vector<Eigen::RowVectorXd> past_;  ///< normalised, newest last
};

}  // namespace patella::bench
