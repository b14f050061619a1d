#include "tools/bench/learning/linear_history.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Cholesky>

namespace patella::bench {
namespace {

constexpr std::array<std::size_t, 10> kLags = {0, 1, 2, 3, 5, 8, 12, 18, 26, 36};  // steps
constexpr double kRidge = 1e-3;  // of a sample, in units of normalised features

}  // namespace

LinearHistory::LinearHistory(std::span<const train::Sequence> sequences, const network::NetworkWeights& frame)
    : frame_(frame) {
  const auto count = static_cast<Eigen::Index>(kLags.size()) * frame.feature_mean.size() + 1;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, frame.output_mean.size());
  double samples = 0.0;
  for (const train::Sequence& sequence : sequences) {
    reset();
    const train::Rows target = targetOf(sequence, frame.output);
    for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
      push(sequence.features.row(step));
      if (sequence.role[static_cast<std::size_t>(step)] == train::Role::kTrain) {
        const Eigen::RowVectorXd row = regressors();
        const Eigen::RowVectorXd wanted =
            (target.row(step) - frame.output_mean.transpose()).cwiseQuotient(frame.output_scale.transpose());
        normal.selfadjointView<Eigen::Lower>().rankUpdate(row.transpose());
        right += row.transpose() * wanted;
        samples += 1.0;
      }
    }
  }
  normal.diagonal().array() += kRidge * samples;
  coefficients_ = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  reset();
}

void LinearHistory::reset() {
  past_.clear();
}

void LinearHistory::push(const Eigen::RowVectorXd& features) {
  const Eigen::RowVectorXd row =
      (features - frame_.feature_mean.transpose()).cwiseQuotient(frame_.feature_scale.transpose());
  if (past_.empty()) {
    past_.assign(kLags.back() + 1, row);
  }
  std::rotate(past_.begin(), past_.begin() + 1, past_.end());
  past_.back() = row;
}

Eigen::RowVectorXd LinearHistory::regressors() const {
  const Eigen::Index width = frame_.feature_mean.size();
  Eigen::RowVectorXd row(static_cast<Eigen::Index>(kLags.size()) * width + 1);
  row[0] = 1.0;
  for (std::size_t i = 0; i < kLags.size(); ++i) {
    row.segment(1 + static_cast<Eigen::Index>(i) * width, width) = past_[past_.size() - 1 - kLags[i]];
  }
  return row;
}

JointVector LinearHistory::step(std::span<const double> features) {
  push(Eigen::Map<const Eigen::RowVectorXd>(features.data(), static_cast<Eigen::Index>(features.size())));
  const Eigen::RowVectorXd normalised = regressors() * coefficients_;
  return normalised.transpose().cwiseProduct(frame_.output_scale) + frame_.output_mean;
}

}  // namespace patella::bench
