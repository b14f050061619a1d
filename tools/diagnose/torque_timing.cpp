#include "tools/diagnose/torque_timing.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "tools/diagnose/dataset.hpp"
#include "tools/diagnose/elementary.hpp"
#include "tools/diagnose/model_fit.hpp"

namespace patella::diagnose {
namespace {

/// Standard deviations that the half period has to be away from none.
constexpr double kSure = 2.0;
/// Half periods: below, the torque was held; above, something else makes the motion come early.
constexpr double kLeast = 0.5;
constexpr double kMost = 2.0;

std::vector<Recording> sampled(std::span<const Recording> recordings) {
  std::vector<Recording> changed(recordings.begin(), recordings.end());
  for (Recording& recording : changed) {
    recording.torque_timing = TorqueTiming::kSampled;
  }
  return changed;
}

struct Estimate {
  double value = 0.0;
  double deviation = 0.0;
};

// Of the last column, beside all others.
Estimate lastCoefficient(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  const Eigen::VectorXd length = columns.colwise().norm().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = columns * length.cwiseInverse().asDiagonal();
  const Eigen::Index last = columns.cols() - 1;
  const auto others = scaled.leftCols(last).completeOrthogonalDecomposition();
  const Eigen::VectorXd own = scaled.col(last) - scaled.leftCols(last) * others.solve(scaled.col(last));
  const Eigen::VectorXd rest = target - scaled.leftCols(last) * others.solve(target);
  const double square = std::max(own.squaredNorm(), 1e-300);
  const double slope = own.dot(rest) / square;
  const double variance = (rest - slope * own).squaredNorm() / static_cast<double>(target.size());
  return {.value = slope / length[last], .deviation = std::sqrt(variance / square) / length[last]};
}

}  // namespace

std::vector<Recording> withTorqueTiming(std::span<const Recording> recordings,
                                        const app::ModelDescription& model) {
  std::vector<Recording> unchanged(recordings.begin(), recordings.end());
  if (recordings.empty() || recordings.front().is_static ||
      !std::all_of(recordings.begin(), recordings.end(),
                   [](const Recording& recording) { return recording.torque_timing_assumed; })) {
    return unchanged;
  }
  const std::vector<Recording> other = sampled(recordings);
  const Dataset as_held(recordings, {});
  const Dataset as_sampled(other, {});
  ModelFitter fitter(as_held, model, {});
  const ModelFit fit = fitter.nominal();
  const std::vector<ElementaryColumn> plain = elementaryColumns(as_held);
  // All that could be missing in the simplest forms, then what half a period makes of the torque.
  Eigen::MatrixXd columns(fit.tangent.rows(),
                          fit.tangent.cols() + static_cast<Eigen::Index>(plain.size()) + 1);
  columns.leftCols(fit.tangent.cols()) = fit.tangent;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    columns.col(fit.tangent.cols() + static_cast<Eigen::Index>(i)) = plain[i].torque;
  }
  columns.rightCols<1>() = as_held.driveTorque() - as_sampled.driveTorque();
  const Estimate halves = lastCoefficient(fit.weighting->apply(columns), fit.weighting->apply(fit.residual));
  if (halves.value < kLeast || halves.value > kMost || halves.value < kSure * halves.deviation) {
    return unchanged;
  }
  std::vector<Recording> result = other;
  result.front().warnings.emplace_back(
      "the motion follows the torque too early for one that was held between samples: taken as what acted at "
      "the "
      "sample; --torque decides");
  return result;
}

}  // namespace patella::diagnose
