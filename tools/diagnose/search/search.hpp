// Looks for the effect that would explain most of what a fit leaves, and says how much chance alone would
// explain.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
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
};

/// The gain of an atom beyond the fit.
struct Screened {
  std::size_t atom = 0;
  double raw_gain = 0.0;    ///< fall of the weighted squared error
  double gain = 0.0;        ///< the same in units of what chance brings a column on average
  bool wrong_sign = false;  ///< the gain would take a sign that physics does not allow
  int dimensions = 0;       ///< columns that the fit does not span already, and nonlinear parameters
  Eigen::VectorXd c;        ///< coefficients of the columns
};

struct ScreeningOptions {
  int replicates = 499;
  std::uint64_t seed = 1;
  Eigen::MatrixXd nuisance{};  ///< Columns that may take up what they can, like the fitted parameters
  /// Chance brings a column at least what its products with the residual vary over time: the encoder's noise
  /// is in both, a push moves the joints, and draws know nothing of that.
  bool goes_with_motion = false;
};

/// How chance treats an atom.
struct ScreenedGroup {
  Eigen::Index first = 0;  ///< column in the basis of all atoms
  Eigen::Index count = 0;
  int dimensions = 0;
  bool one_sided = false;
  double unit = 1.0;          ///< mean square that chance brings a column
  double seen_in_time = 0.0;  ///< the same from the recording itself; see ScreeningOptions
};

/// Mean square that chance brings a column of a recording's own residual, where it brings draws `unit`.
double withMotion(const ScreenedGroup& group, double unit);

/// Tests atoms on what a fit leaves. What counts as much is not a sum of squares but how it compares with the
/// same sum in residuals drawn from the fit's noise: drawn, filtered and projected like the recording itself.
class Screening {
 public:
  Screening(const Dataset& data, const ModelFit& fit, const Atoms& atoms, const ScreeningOptions& options);

  const std::vector<Screened>& results() const noexcept { return results_; }

  using Statistic = std::function<double(double gain, int dimensions)>;
  /// Largest statistic over all atoms in data that the fit explains but for its noise; nominal parameters
  /// drawn from their tolerance. One value a replicate.
  std::vector<double> chance(const Statistic& statistic) const;

  /// One for each atom.
  const std::vector<ScreenedGroup>& groups() const noexcept { return groups_; }
  /// Orthonormal columns of an atom: weighted rows, the fit's share taken out, and the priors' rows below.
  Eigen::MatrixXd basis(std::size_t atom) const;
  /// Products of all atoms' bases with rows like those.
  Eigen::VectorXf products(const Eigen::VectorXd& rows) const;

 private:
  /// The fit's weighted residual over the rows of the recording, and below them over those of the priors.
  struct Left {
    const Eigen::VectorXd& residual;
    Eigen::Index white_rows;
    int joints;
  };
  void screen(const Atom& atom, std::size_t index, const Eigen::Ref<const Eigen::MatrixXd>& group,
              const Eigen::VectorXd& before, const Left& left, const ScreeningOptions& options,
              Eigen::Index& used);
  void drawChance(const Dataset& data, const ModelFit& fit, const ScreeningOptions& options);

  Eigen::MatrixXd explained_;  ///< orthonormal basis of the tangent, weighted, with the priors' rows below
  Eigen::MatrixXf basis_;      ///< of the atoms, orthonormal within each group
  Eigen::MatrixXf products_;   ///< of the basis with the draws
  std::vector<ScreenedGroup> groups_;
  std::vector<Screened> results_;
};

/// Orthonormal basis of what a fit's parameters and nuisance columns can take up: weighted rows, below them
/// those of the priors.
Eigen::MatrixXd takenUp(const ModelFit& fit, const Eigen::VectorXd& prior_weight,
                        const Eigen::MatrixXd& nuisance = {});

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
