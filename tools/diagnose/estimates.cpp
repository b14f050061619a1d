#include "tools/diagnose/estimates.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/effect.hpp"
#include "tools/diagnose/gates.hpp"
#include "tools/diagnose/search.hpp"

namespace patella::diagnose {
namespace {

constexpr double kDeviations95 = 1.959964;
/// Of a factor: nothing is known of what it multiplies.
constexpr double kLargestLogarithm = 50.0;

}  // namespace

Eigen::MatrixXd widerCovariance(const Dataset& data, const ModelFit& fit, int replicates,
                                std::uint64_t seed) {
  const Eigen::MatrixXd drawn = parameterCovariance(data, fit, replicates, seed);
  const Eigen::VectorXd left_out = jackknifeCovariance(fit).diagonal();
  const Eigen::VectorXd factor = (left_out.array() / drawn.diagonal().array().max(1e-300)).max(1.0).sqrt();
  return factor.asDiagonal() * drawn * factor.asDiagonal();
}

std::vector<ParameterEstimate> estimates(const ModelFit& fit, const Eigen::MatrixXd& all_covariance,
                                         std::size_t index) {
  const Term& term = fit.terms[index];
  const auto& descriptor = *model::findEffect(term.recipe->kind);
  const std::vector<double> values = ModelFitter::effectParameters(term);
  const auto count = static_cast<Eigen::Index>(term.c.size() + term.nu.size());
  Eigen::MatrixXd slope(static_cast<Eigen::Index>(values.size()), count);
  Eigen::MatrixXd covariance = all_covariance.block(fit.offset[index], fit.offset[index], count, count);
  // Curvature says nothing of which of a rugged objective's neighbouring valleys is the lowest by chance.
  for (std::size_t k = 0; k < term.nu.size(); ++k) {
    const auto place = static_cast<Eigen::Index>(term.c.size() + k);
    covariance(place, place) += std::pow(term.recipe->nonlinear[k].step, 2);
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    Term moved = term;
    const auto i = static_cast<std::size_t>(k);
    double& value = i < term.c.size() ? moved.c[i] : moved.nu[i - term.c.size()];
    const double step = std::max(1e-3 * std::sqrt(covariance(k, k)), 1e-9);
    value += step;
    const std::vector<double> there = ModelFitter::effectParameters(moved);
    for (std::size_t p = 0; p < values.size(); ++p) {
      slope(static_cast<Eigen::Index>(p), k) = (there[p] - values[p]) / step;
    }
  }
  const Eigen::MatrixXd propagated = slope * covariance * slope.transpose();
  std::vector<ParameterEstimate> all;
  for (std::size_t p = 0; p < values.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    const double half = kDeviations95 * std::sqrt(std::max(0.0, propagated(row, row)));
    // A modelling choice is an estimate where it was fitted.
    if (descriptor.parameters[p].identified || slope.row(row).squaredNorm() > 0.0) {
      all.push_back({.name = std::string(descriptor.parameters[p].name),
                     .value = values[p],
                     .ci95 = {values[p] - half, values[p] + half},
                     .by_factor = term.recipe->by_factors});
      if (all.back().by_factor) {
        const double factor = std::exp(std::min(half / values[p], kLargestLogarithm));
        all.back().ci95 = {values[p] / factor, values[p] * factor};
      }
    }
  }
  return all;
}

}  // namespace patella::diagnose
