// Fits a model to a dataset: nominal parameters within their tolerance, declared effects within theirs, found
// effects within physics, all at once and weighted by the noise (generalised least squares).
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "core/model/model_description.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/fit/angle_shift.hpp"
#include "tools/diagnose/fit/edges.hpp"
#include "tools/diagnose/fit/mechanism_parameters.hpp"
#include "tools/diagnose/fit/passive_scale.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/noise_model.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

/// An effect in the fit.
struct Term {
  std::shared_ptr<const Recipe> recipe;
  std::vector<double> c;
  std::vector<double> nu;
  bool declared = false;        ///< part of the model that was given: held near its values
  std::vector<double> prior_c;  ///< those values
  std::vector<Term> replaced;   ///< declared terms in whose place it stands
};

/// A set of effects with their estimates, and how well it explains the data.
struct ModelFit {
  std::vector<double> mechanism;  ///< z of MechanismParameters, 0 for the nominal one
  std::vector<Term> terms;
  double objective = 0.0;  ///< under `weighting`; comparable between fits of the same weighting
  std::shared_ptr<const Weighting> weighting;  ///< scaled to this fit's own residual
  Eigen::VectorXd residual;                    ///< torque that is left, as a Column
  Eigen::MatrixXd tangent;  ///< derivatives of the explained torque by every free parameter, as Columns
  /// Each parameter's 1 / standard deviation, times `prior_scale`; 0 where nothing is known.
  Eigen::VectorXd prior_weight;
  double prior_scale = 1.0;
  Eigen::VectorXd prior_residual;  ///< weighted distance from what is known to each parameter
  /// Where the terms' parameters start in that order: mechanism first, then c and ν of each term.
  std::vector<Eigen::Index> offset;
  std::vector<Edge> at_edge;

  /// Times that a squared error counts too much.
  double redundancy() const noexcept { return prior_scale * prior_scale; }
  /// It has effects that the given model lacks.
  bool namesAny() const noexcept {
    return std::any_of(terms.begin(), terms.end(), [](const Term& term) { return !term.declared; });
  }
};

struct FitOptions {
  double nominal_tolerance = runaway::kTolerance;
};

class ModelFitter {
 public:
  /// The dataset must outlive it.
  ModelFitter(const Dataset& data, const model::ModelDescription& nominal, const FitOptions& options);

  const Dataset& data() const noexcept { return *data_; }
  /// rms of the torque on each joint below which nothing is missed, N·m.
  const std::vector<double>& leastTorque_Nm() const noexcept { return least_torque_Nm_; }
  /// The model as given, refitted within its tolerances.
  ModelFit nominal();
  /// Rows that follow each other closely say less than their number. Squared errors count `redundancy` times
  /// too much, so what is known beforehand has to count as often to keep its weight.
  void setRedundancy(double redundancy) noexcept { prior_scale_ = std::sqrt(redundancy); }

  /// Fits the terms anew from their present values.
  ModelFit fit(ModelFit start, const Weighting& weighting);

  /// The same fit with effects that were fitted to the torque that the motion asked for
  /// (Recipe::by_asked_torque) acting on the whole torque, as they do in the machine: what is left then is
  /// what nothing explains.
  ModelFit onWholeTorque(ModelFit fit);

  /// Basis of a recipe as Columns.
  Eigen::MatrixXd basis(const Recipe& recipe, std::span<const double> nu);
  /// The given model with the fit's parameters and effects, as model files hold it.
  model::ModelDescription describe(const ModelFit& fit) const;
  static std::vector<double> effectParameters(const Term& term);
  /// Torque that a term takes from the drives, as a Column.
  Eigen::VectorXd torque(const Term& term);

  /// What ModelFit::mechanism means.
  const MechanismParameters& mechanism() const noexcept { return *mechanism_; }
  const FitOptions& options() const noexcept { return options_; }

 private:
  class Cost;
  /// Addition of Recipe::shifts_angle to the mechanism's regressor.
  Eigen::MatrixXd shift(int joint, double angle_rad);
  /// The same for the torque of the nominal mechanism.
  Eigen::VectorXd torqueShift(int joint, double angle_rad);
  /// Regressor of the mechanism where it stands.
  Eigen::MatrixXd regressorOf(const ModelFit& fit);
  /// Torque that drives which obey would have to give, as a Column.
  Eigen::VectorXd toGive(const ModelFit& fit);
  /// Columns of such torques as the drives are told (Recipe::scales_all), and as PassiveScale counts them
  /// where there is no drive.
  Eigen::MatrixXd scaled(const ModelFit& fit, Eigen::MatrixXd columns) const;
  Eigen::VectorXd unexplained(const ModelFit& fit);
  /// Of a recipe's effect with these parameters, worked out once.
  const Column& columnOf(const Recipe& recipe, const std::vector<double>& parameters);
  void solve(ModelFit& fit, const Weighting& weighting);
  void linearise(ModelFit& fit);
  void addDeclared(const model::ModelDescription& nominal);

  const Dataset* data_;
  model::ModelDescription nominal_;
  model::DynamicsModel bare_;  ///< the nominal mechanism without effects
  FitOptions options_;
  std::unique_ptr<MechanismParameters> mechanism_;
  PassiveScale passive_;
  std::vector<double> least_torque_Nm_;
  Eigen::MatrixXd regressor_;
  Eigen::VectorXd torque_;
  Eigen::VectorXd nominal_torque_;
  Eigen::VectorXd fixed_torque_;  ///< of declared effects that have no free coefficient
  std::vector<Term> declared_;
  double prior_scale_ = 1.0;
  std::vector<model::EffectDescription> fixed_;  ///< declared effects that are kept as they are
  std::map<std::string, Column> cache_;
  /// By joint, once one is asked for.
  std::map<int, AngleShift> regressor_shifts_, torque_shifts_;
};

}  // namespace patella::diagnose
