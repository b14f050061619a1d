// Columns that a search tries, and what chance alone makes of the parameters of a fit.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

/// Columns that a search tries together: a recipe at one point of its grid, or a smooth function of a
/// variable.
struct Atom {
  std::shared_ptr<const Recipe> recipe;  ///< nullptr for a function of a variable
  std::vector<double> nu;
  std::string label;
  int joint = 0;
  Eigen::Index first = 0;
  Eigen::Index count = 0;
  int nonlinear = 0;  ///< parameters beyond the columns' coefficients, which the search over atoms fits
};

/// Atoms and their columns.
struct Atoms {
  std::vector<Atom> items;
  /// Side by side, but for those of oscillations: thousands of frequencies are worked out when they are
  /// asked for.
  Eigen::MatrixXd columns;
  const Dataset* data = nullptr;  ///< whose rows the oscillations have; outlives the atoms

  Eigen::MatrixXd of(const Atom& atom) const;
  /// The joint that an atom acts on; nothing where there are several.
  std::optional<int> onlyJoint(const Atom& atom) const;
};

/// Share of its length below which what others leave of a column is rounding.
inline constexpr double kSpanned = 1e-7;

/// Columns of a fit's parameters and nuisance columns: weighted rows, below them those of the priors.
struct FreeColumns {
  Eigen::MatrixXd weighted;  ///< brought to one length, or a rank would depend on units
  Eigen::VectorXd length;    ///< that they had; 1 for a column of zeros
};
FreeColumns freeColumns(const ModelFit& fit, const Eigen::VectorXd& prior_weight,
                        const Eigen::MatrixXd& nuisance = {});

/// Orthonormal basis of what a fit's parameters and nuisance columns can take up: weighted rows, below them
/// those of the priors.
Eigen::MatrixXd takenUp(const ModelFit& fit, const Eigen::VectorXd& prior_weight,
                        const Eigen::MatrixXd& nuisance = {});

/// Residuals drawn from a fit's noise, weighted, one beside the other; below them rows of the priors.
Eigen::MatrixXd weightedDraws(const Dataset& data, const ModelFit& fit, int count, std::mt19937_64& random);

/// How many times its share of the squared weighted error chance brings the last `count` parameters of a fit,
/// drawn from the fit's own noise: 1 where the weighted residual is white.
double chanceUnit(const Dataset& data, const ModelFit& fit, Eigen::Index count, std::uint64_t seed);

/// The same for all parameters of a fit together: how many rows of its weighted residual say what one would
/// if they were white.
double redundancy(const Dataset& data, const ModelFit& fit, std::uint64_t seed);

/// Covariance of a fit's parameters, from fits to residuals drawn from its noise.
Eigen::MatrixXd parameterCovariance(const Dataset& data, const ModelFit& fit, int replicates,
                                    std::uint64_t seed);

Atoms recipeAtoms(ModelFitter& fitter, std::span<const std::shared_ptr<const Recipe>> recipes);

/// Share of `values` that reach `observed`, counting the observation itself: never 0.
double exceedance(std::span<const double> values, double observed);

}  // namespace patella::diagnose
