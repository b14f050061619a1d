#include "tools/diagnose/search/rugged_start.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {
namespace {

/// Steps of a descent are so many times those of the recipe at first, and halve.
constexpr double kFirstSteps = 4.0;
constexpr double kLastSteps = 0.25;
constexpr int kMostTries = 160;

using Height = std::function<double(const std::vector<double>&)>;

// Downhill in steps along the axes and the diagonals between two of them, which halve.
std::vector<double> downhill(const Recipe& recipe, const Height& height, std::vector<double> nu) {
  double least = height(nu);
  int tries = 0;
  const auto tryStep = [&](std::vector<double> moved) {
    for (std::size_t k = 0; k < nu.size(); ++k) {
      const NonlinearParameter& range = recipe.nonlinear[k];
      moved[k] = std::clamp(nu[k] + moved[k] * range.step, range.lower, range.upper);
    }
    ++tries;
    const double value = height(moved);
    const bool better = value < least;
    if (better) {
      least = value;
      nu = moved;
    }
    return better;
  };
  for (double steps = kFirstSteps; steps >= kLastSteps; steps /= 2.0) {
    for (bool better = true; better && tries < kMostTries;) {
      better = false;
      for (std::size_t k = 0; k < nu.size(); ++k) {
        for (std::size_t other = k; other < nu.size(); ++other) {
          for (const auto& [one, two] : {std::pair{1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}}) {
            if (other == k && one != two) {
              continue;
            }
            std::vector<double> move(nu.size(), 0.0);
            move[other] = two * steps;
            move[k] = one * steps;
            better = tryStep(std::move(move)) || better;
          }
        }
      }
    }
  }
  return nu;
}

std::vector<double> lowest(const Height& height, std::vector<double> among,
                           const std::vector<std::vector<double>>& others) {
  double least = height(among);
  for (const std::vector<double>& point : others) {
    if (const double value = height(point); value < least) {
      least = value;
      among = point;
    }
  }
  return among;
}

}  // namespace

std::vector<double> ruggedStart(ModelFitter& fitter, const ModelFit& fit, const Recipe& recipe,
                                std::vector<double> nu) {
  const bool rugged = std::any_of(recipe.nonlinear.begin(), recipe.nonlinear.end(),
                                  [](const NonlinearParameter& range) { return range.step > 0.0; });
  if (!rugged || recipe.coefficients() > 0) {
    return nu;
  }
  const Eigen::MatrixXd explained = takenUp(fit, fit.prior_weight);
  const Height left = [&](const std::vector<double>& at) {
    const Eigen::VectorXd white = fit.weighting->apply(fit.residual - fitter.basis(recipe, at));
    Eigen::VectorXd rest(explained.rows());
    rest << white, fit.prior_residual;
    return rest.squaredNorm() - (explained.transpose() * rest).squaredNorm();
  };
  // Weighting sharpens what impacts leave: an impact at the wrong time is worse than none. Without it valleys
  // are wide enough for the grid to find.
  const auto plain = fit.tangent.householderQr();
  const Eigen::MatrixXd plainly =
      plain.householderQ() * Eigen::MatrixXd::Identity(fit.tangent.rows(), fit.tangent.cols());
  const Height left_plain = [&](const std::vector<double>& at) {
    const Eigen::VectorXd rest = fit.residual - fitter.basis(recipe, at);
    return rest.squaredNorm() - (plainly.transpose() * rest).squaredNorm();
  };
  std::vector<std::vector<double>> starts = recipe.grid;
  starts.insert(starts.end(), recipe.valleys.begin(), recipe.valleys.end());
  const std::vector<double> widest = lowest(left_plain, nu, starts);
  starts.push_back(downhill(recipe, left_plain, nu));
  starts.push_back(downhill(recipe, left_plain, widest));
  return downhill(recipe, left, lowest(left, nu, starts));
}

}  // namespace patella::diagnose
