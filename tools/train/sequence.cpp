#include "tools/train/sequence.hpp"

#include <cmath>
#include <stdexcept>

namespace patella::train {
namespace {

using network::OutputKind;

/// Mean and standard deviation of columns over the steps that are trained on.
class ColumnMoments {
 public:
  explicit ColumnMoments(Eigen::Index columns)
      : sum_(Eigen::VectorXd::Zero(columns)), squares_(Eigen::VectorXd::Zero(columns)) {}

  void add(const Rows& rows, const std::vector<Role>& role) {
    for (Eigen::Index step = 0; step < rows.rows(); ++step) {
      if (role[static_cast<std::size_t>(step)] == Role::kTrain) {
        const Eigen::VectorXd row = rows.row(step).transpose();
        shift_ = count_ == 0 ? row : shift_;
        sum_ += row - shift_;
        squares_ += (row - shift_).cwiseAbs2();
        ++count_;
      }
    }
  }
  std::size_t count() const noexcept { return count_; }
  Eigen::VectorXd mean() const { return shift_ + sum_ / static_cast<double>(count_); }
  Eigen::VectorXd scale() const {
    constexpr double kConstant = 1e-9;
    const auto n = static_cast<double>(count_);
    const Eigen::VectorXd variance = squares_ / n - (sum_ / n).cwiseAbs2();
    return variance.unaryExpr([](double v) { return v > kConstant * kConstant ? std::sqrt(v) : 1.0; });
  }

 private:
  Eigen::VectorXd sum_;
  Eigen::VectorXd squares_;
  Eigen::VectorXd shift_;  ///< the first row: sums of squares of time would cost digits
  std::size_t count_ = 0;
};

}  // namespace

bool isCorrection(OutputKind output) noexcept {
  return output == OutputKind::kAccelerationCorrection || output == OutputKind::kTorqueCorrection;
}

bool isTorque(OutputKind output) noexcept {
  return output == OutputKind::kTorque || output == OutputKind::kTorqueCorrection;
}

Rows targetOf(const Sequence& sequence, OutputKind output) {
  return isCorrection(output) ? Rows(sequence.reference - sequence.observer) : sequence.reference;
}

Rows scaled(const Rows& rows, const Eigen::VectorXd& mean, const Eigen::VectorXd& scale) {
  return (rows.rowwise() - mean.transpose()).array().rowwise() / scale.transpose().array();
}

network::NetworkWeights frameOf(std::span<const Sequence> sequences, const std::vector<std::string>& features,
                                OutputKind output) {
  if (sequences.empty()) {
    throw std::invalid_argument("there is no recording to train on");
  }
  const Sequence& first = sequences.front();
  ColumnMoments of_features(first.features.cols());
  ColumnMoments of_target(first.reference.cols());
  for (const Sequence& sequence : sequences) {
    of_features.add(sequence.features, sequence.role);
    of_target.add(targetOf(sequence, output), sequence.role);
  }
  if (of_features.count() == 0) {
    throw std::invalid_argument(
        "no step is left to train on, expected a smaller share held out or more data");
  }
  network::NetworkWeights frame;
  frame.features = features;
  frame.feature_mean = of_features.mean();
  frame.feature_scale = of_features.scale();
  frame.output_mean = of_target.mean();
  frame.output_scale = of_target.scale();
  frame.rate_Hz = first.rate_Hz;
  frame.output = output;
  return frame;
}

}  // namespace patella::train
