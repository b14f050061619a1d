#include "tools/diagnose/search/estimates.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/declared.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/recipe_names.hpp"
#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Logarithm of a factor from which on nothing is known of what it multiplies.
constexpr double kUnknownLogarithm = 50.0;
/// Of a joint that leaves nothing at all.
constexpr double kLeastVariance_Nm2 = 1e-18;

// Names of the parameters at which the fit came to the end of a range.
std::set<std::string> atBound(const Term& term) {
  const Recipe& recipe = *term.recipe;
  std::set<std::string> names;
  for (std::size_t i = 0; i < term.c.size(); ++i) {
    if ((recipe.nonnegative[i] && term.c[i] <= 0.0) || std::abs(term.c[i]) >= recipe.largest) {
      names.insert(coefficientName(recipe, term.nu, i));
    }
  }
  for (std::size_t k = 0; k < term.nu.size(); ++k) {
    const NonlinearParameter& range = recipe.nonlinear[k];
    const double near = 1e-6 * (range.upper - range.lower);
    if (term.nu[k] <= range.lower + near || (term.nu[k] >= range.upper - near && !range.open_above)) {
      names.insert(shapeName(recipe, term.c, term.nu, k));
    }
  }
  return names;
}

// The covariance with variances of at least these; correlations stay.
Eigen::MatrixXd widened(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& least_variance) {
  const Eigen::VectorXd factor =
      (least_variance.array() / covariance.diagonal().array().max(1e-300)).max(1.0).sqrt();
  return factor.asDiagonal() * covariance * factor.asDiagonal();
}

}  // namespace

Eigen::MatrixXd widerCovariance(const Dataset& data, const ModelFit& fit, int replicates,
                                std::uint64_t seed) {
  return widened(parameterCovariance(data, fit, replicates, seed), jackknifeCovariance(fit).diagonal());
}

Eigen::MatrixXd withRest(const Eigen::MatrixXd& covariance, const Dataset& data, const ModelFit& fit,
                         std::span<const JointRest> rests) {
  const auto rows = static_cast<double>(data.rows());
  Eigen::MatrixXd information = (fit.prior_weight / fit.prior_scale).cwiseAbs2().asDiagonal();
  for (std::size_t joint = 0; joint < rests.size(); ++joint) {
    const double noise_Nm2 = rests[joint].noise_Nm * rests[joint].noise_Nm;
    const double variance_Nm2 =
        noise_Nm2 + std::pow(rests[joint].structure_Nm(), 2) * rows / asserted::kLooks;
    const auto slope = fit.tangent.middleRows(static_cast<Eigen::Index>(joint) * data.rows(), data.rows());
    information += gramOf(slope) / std::max(variance_Nm2, kLeastVariance_Nm2);
  }
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlated = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::MatrixXd inverse = correlated.completeOrthogonalDecomposition().pseudoInverse();
  return widened(covariance, inverse.diagonal().cwiseProduct(scale.cwiseAbs2()));
}

Eigen::MatrixXd parameterSlopes(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t index) {
  const Term& term = fit.terms[index];
  const std::vector<double> values = ModelFitter::effectParameters(term);
  const auto count = static_cast<Eigen::Index>(term.c.size() + term.nu.size());
  Eigen::MatrixXd slope(static_cast<Eigen::Index>(values.size()), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    Term moved = term;
    const auto i = static_cast<std::size_t>(k);
    double& value = i < term.c.size() ? moved.c[i] : moved.nu[i - term.c.size()];
    const Eigen::Index place = fit.offset[index] + k;
    const double step = std::max(1e-3 * std::sqrt(covariance(place, place)), 1e-9);
    value += step;
    const std::vector<double> there = ModelFitter::effectParameters(moved);
    for (std::size_t p = 0; p < values.size(); ++p) {
      slope(static_cast<Eigen::Index>(p), k) = (there[p] - values[p]) / step;
    }
  }
  return slope;
}

Eigen::MatrixXd withBumps(Eigen::MatrixXd covariance, const ModelFit& fit) {
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    for (std::size_t k = 0; k < term.nu.size(); ++k) {
      const Eigen::Index place = fit.offset[t] + static_cast<Eigen::Index>(term.c.size() + k);
      const NonlinearParameter& parameter = term.recipe->nonlinear[k];
      covariance(place, place) += std::pow(parameter.step, 2) + std::pow(parameter.assumption, 2);
    }
  }
  return covariance;
}

std::optional<double> torqueError(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t index) {
  const Term& term = fit.terms[index];
  std::vector<Eigen::Index> places, others;
  std::vector<double> strengths;
  for (std::size_t i = 0; i < term.c.size(); ++i) {
    const std::string name = coefficientName(*term.recipe, term.nu, i);
    const std::string& kind = term.recipe->kind;
    const bool counts =
        isLogStrength(kind, name) || (effectHome(kind).told_by_torque && isStrength(kind, name));
    (counts ? places : others).push_back(fit.offset[index] + static_cast<Eigen::Index>(i));
    if (counts) {
      strengths.push_back(term.c[i]);
    }
  }
  if (places.empty()) {
    return std::nullopt;
  }
  for (std::size_t k = 0; k < term.nu.size(); ++k) {
    places.push_back(fit.offset[index] + static_cast<Eigen::Index>(term.c.size() + k));
  }
  Eigen::MatrixXd slopes = fit.tangent(Eigen::all, places);
  if (!others.empty()) {
    // What the other coefficients can make, as a constant torque, is not the strengths'.
    const Eigen::MatrixXd besides = fit.tangent(Eigen::all, others);
    slopes -= besides * besides.householderQr().solve(slopes).eval();
  }
  const auto count = static_cast<Eigen::Index>(strengths.size());
  const Column torque = slopes.leftCols(count) * Eigen::Map<const Eigen::VectorXd>(strengths.data(), count);
  const Eigen::MatrixXd known = withBumps(covariance, fit)(places, places);
  const double variance = known.cwiseProduct(gramOf(slopes)).sum();
  return kDeviations95 * std::sqrt(std::max(variance, 0.0) / torque.squaredNorm());
}

std::vector<ParameterEstimate> estimates(const ModelFit& fit, const Eigen::MatrixXd& all_covariance,
                                         std::size_t index) {
  const Term& term = fit.terms[index];
  const auto& descriptor = *model::findEffect(term.recipe->kind);
  const std::vector<double> values = ModelFitter::effectParameters(term);
  const auto count = static_cast<Eigen::Index>(term.c.size() + term.nu.size());
  const Eigen::MatrixXd known = withBumps(all_covariance, fit);
  const Eigen::MatrixXd slope = parameterSlopes(fit, known, index);
  const Eigen::MatrixXd covariance = known.block(fit.offset[index], fit.offset[index], count, count);
  const std::set<std::string> at_bound = atBound(term);
  const Eigen::MatrixXd propagated = slope * covariance * slope.transpose();
  std::vector<ParameterEstimate> all;
  for (std::size_t p = 0; p < values.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    const double half = kDeviations95 * std::sqrt(std::max(0.0, propagated(row, row)));
    const std::string name(descriptor.parameters[p].name);
    const auto& assumed = term.recipe->assumed;
    const bool is_assumed = std::find(assumed.begin(), assumed.end(), name) != assumed.end();
    // A modelling choice is an estimate where it was fitted.
    if (descriptor.parameters[p].identified || (slope.row(row).squaredNorm() > 0.0 && !is_assumed)) {
      all.push_back({.name = name,
                     .value = values[p],
                     .ci95 = {values[p] - half, values[p] + half},
                     .by_factor = term.recipe->by_factors,
                     .at_bound = at_bound.contains(name)});
      if (all.back().by_factor) {
        const double factor = std::exp(std::min(half / values[p], kUnknownLogarithm));
        all.back().ci95 = {values[p] / factor, values[p] * factor};
      }
    }
  }
  return all;
}

std::vector<RefittedParameter> refittedParameters(const ModelFitter& fitter, const ModelFit& fit,
                                                  const Eigen::MatrixXd& covariance) {
  const double tolerance = fitter.options().nominal_tolerance;
  const double widest = runaway::kWithinTolerance * tolerance;
  const Eigen::MatrixXd slopes = fitter.mechanism().namedSlopes(fit.mechanism);
  const Eigen::MatrixXd spread =
      slopes * covariance.topLeftCorner(slopes.cols(), slopes.cols()) * slopes.transpose();
  std::vector<RefittedParameter> all;
  for (const NamedParameter& parameter : fitter.mechanism().named(fit.mechanism)) {
    const auto row = static_cast<Eigen::Index>(all.size());
    const double away = widest * parameter.spread;
    all.push_back({.name = parameter.name,
                   .made_of = parameter.made_of,
                   .nominal = parameter.nominal,
                   .refitted = parameter.value,
                   .sd = std::sqrt(std::max(0.0, spread(row, row))),
                   .known_sd = tolerance * parameter.spread,
                   .tolerated = {parameter.nominal - away, parameter.nominal + away},
                   .is_ratio = parameter.is_ratio});
    if (parameter.is_ratio) {
      all.back().tolerated = {parameter.nominal * std::exp(-widest), parameter.nominal * std::exp(widest)};
    }
  }
  return all;
}

}  // namespace patella::diagnose
