#include "tools/diagnose/search/correlations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/effect.hpp"
#include "tools/diagnose/search/estimates.hpp"

namespace patella::diagnose {

Correlations correlationsOf(const ModelFit& fit, std::span<const std::string> mechanism_names,
                            const Eigen::MatrixXd& mechanism_slopes, const Eigen::MatrixXd& covariance) {
  Correlations result;
  // Derivatives of the named parameters, a row each, by those of the fit.
  std::vector<Eigen::RowVectorXd> rows;
  for (std::size_t i = 0; i < mechanism_names.size(); ++i) {
    result.parameters.push_back(mechanism_names[i]);
    rows.emplace_back(Eigen::RowVectorXd::Zero(covariance.cols()));
    rows.back().head(mechanism_slopes.cols()) = mechanism_slopes.row(static_cast<Eigen::Index>(i));
  }
  const Eigen::MatrixXd known = withBumps(covariance, fit);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Recipe& recipe = *fit.terms[t].recipe;
    const Eigen::MatrixXd slopes = parameterSlopes(fit, known, t);
    for (Eigen::Index p = 0; p < slopes.rows(); ++p) {
      if (slopes.row(p).squaredNorm() > 0.0) {
        const auto& parameter = model::findEffect(recipe.kind)->parameters[static_cast<std::size_t>(p)];
        result.parameters.push_back(recipe.label() + " " + std::string(parameter.name));
        rows.emplace_back(Eigen::RowVectorXd::Zero(covariance.cols()));
        rows.back().segment(fit.offset[t], slopes.cols()) = slopes.row(p);
      }
    }
  }
  Eigen::MatrixXd named(static_cast<Eigen::Index>(rows.size()), covariance.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    named.row(static_cast<Eigen::Index>(i)) = rows[i];
  }
  const Eigen::MatrixXd spread = named * known * named.transpose();
  for (Eigen::Index i = 0; i < spread.rows(); ++i) {
    std::vector<double>& row = result.matrix.emplace_back();
    for (Eigen::Index j = 0; j < spread.cols(); ++j) {
      const double scale = std::sqrt(spread(i, i)) * std::sqrt(spread(j, j));
      row.push_back(scale > 0.0 ? std::clamp(spread(i, j) / scale, -1.0, 1.0)
                                : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return result;
}

}  // namespace patella::diagnose
