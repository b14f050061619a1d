#include "tools/diagnose/fit/model_fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Dense>
#include <ceres/ceres.h>
#include <fmt/format.h>

#include "tools/diagnose/effects/declared.hpp"
#include "tools/diagnose/fit/edges.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"

namespace patella::diagnose {
namespace {

/// Estimates of the noise's scale and of the parameters in turn.
constexpr int kNoiseRounds = 2;

/// Numbers in kept columns before the store is emptied: those of a search and of one fit have room in it.
constexpr Eigen::Index kCachedNumbers = 25'000'000;
constexpr int kIterations = 25;
/// Relative change of half the squared weighted error, of which a row has about a half: some 0.05 of it,
/// where decisions weigh whole units. Flat valleys, where little is to be had in many steps, end here.
constexpr double kNoFurtherGain = 1e-5;

Eigen::Index shapeIndex(const ModelFit& fit, std::size_t term, std::size_t k) {
  return fit.offset[term] + static_cast<Eigen::Index>(fit.terms[term].c.size() + k);
}

Eigen::VectorXd weighted(const Eigen::MatrixXd& basis, std::span<const double> c) {
  if (c.empty()) {
    return basis.col(0);
  }
  return basis * Eigen::Map<const Eigen::VectorXd>(c.data(), static_cast<Eigen::Index>(c.size()));
}

}  // namespace

// Parameters in one block: mechanism, then c and ν of each term. Residuals: whitened torque, then priors.
class ModelFitter::Cost final : public ceres::CostFunction {
 public:
  Cost(ModelFitter& fitter, const ModelFit& layout, const Weighting& weighting)
      : fitter_(fitter), layout_(layout), weighting_(weighting), priors_(layout.prior_weight.size()) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(priors_));
    set_num_residuals(static_cast<int>(weighting.rows() * fitter.data_->joints() + priors_));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    ModelFit at = layout_;
    scatter(std::span(parameters[0], static_cast<std::size_t>(priors_)), at);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      fitter_.linearise(at);
      const Eigen::MatrixXd slope = weighting_.apply(at.tangent);
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
          jacobians[0], slope.rows() + priors_, priors_);
      jacobian.topRows(slope.rows()) = -slope;
      jacobian.bottomRows(priors_) = layout_.prior_weight.asDiagonal();
    } else {
      at.residual = fitter_.unexplained(at);
    }
    const Eigen::VectorXd white = weighting_.apply(at.residual);
    Eigen::Map<Eigen::VectorXd> out(residuals, white.size() + priors_);
    out.head(white.size()) = white;
    out.tail(priors_) = priorResiduals(at);
    return true;
  }

  static std::vector<double> gather(const ModelFit& fit) {
    std::vector<double> all = fit.mechanism;
    for (const Term& term : fit.terms) {
      all.insert(all.end(), term.c.begin(), term.c.end());
      all.insert(all.end(), term.nu.begin(), term.nu.end());
    }
    return all;
  }

  static void scatter(std::span<const double> all, ModelFit& fit) {
    std::size_t at = 0;
    const auto take = [&](std::vector<double>& values) {
      for (double& value : values) {
        value = all[at++];
      }
    };
    take(fit.mechanism);
    for (Term& term : fit.terms) {
      take(term.c);
      take(term.nu);
    }
  }

  static Eigen::VectorXd priorResiduals(const ModelFit& fit) {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(fit.prior_weight.size());
    for (std::size_t i = 0; i < fit.mechanism.size(); ++i) {
      values[static_cast<Eigen::Index>(i)] = fit.mechanism[i];
    }
    for (std::size_t t = 0; t < fit.terms.size(); ++t) {
      for (std::size_t i = 0; i < fit.terms[t].prior_c.size(); ++i) {
        values[fit.offset[t] + static_cast<Eigen::Index>(i)] = fit.terms[t].c[i] - fit.terms[t].prior_c[i];
      }
      for (std::size_t k = 0; k < fit.terms[t].nu.size(); ++k) {
        // Counts where the recipe knows a spread about zero; elsewhere the weight is zero.
        values[shapeIndex(fit, t, k)] = fit.terms[t].nu[k];
      }
    }
    return values.cwiseProduct(fit.prior_weight);
  }

 private:
  ModelFitter& fitter_;
  const ModelFit& layout_;
  const Weighting& weighting_;
  Eigen::Index priors_;
};

ModelFitter::ModelFitter(const Dataset& data, const model::ModelDescription& nominal,
                         const FitOptions& options)
    : data_(&data),
      nominal_(nominal),
      bare_(model::makeModel({.mechanism = nominal.mechanism, .effects = {}})),
      options_(options) {
  regressor_ = data.regressor(bare_.mechanism(), JointVector::Zero(data.joints()));
  torque_ = data.driveTorque();
  const model::BaseParameters base = bare_.mechanism().baseParameters();
  const bool keeps_scale = torque_.isZero(0.0) || swingsFreely(data, regressor_, base);
  mechanism_ = mechanismParameters(nominal.mechanism, keeps_scale);
  if (!keeps_scale) {
    passive_ = PassiveScale(data, regressor_, base, drivenJoints(data, bare_.mechanism()));
  }
  for (const double load_Nm : loads_Nm(data, torque_, regressor_, base)) {
    least_torque_Nm_.push_back(accepted::kLeastOfLoad * load_Nm);
  }
  fixed_torque_ = Eigen::VectorXd::Zero(torque_.size());
  addDeclared(nominal);
  model::DynamicsModel whole = model::makeModel(nominal);
  nominal_torque_ = data.modelTorque(whole);
}

Eigen::VectorXd ModelFitter::unexplained(const ModelFit& fit) {
  return torque_ - scaled(fit, toGive(fit));
}

Eigen::VectorXd ModelFitter::toGive(const ModelFit& fit) {
  Eigen::VectorXd sum = fixed_torque_ + regressorOf(fit) * mechanism_->baseParameters(fit.mechanism);
  for (const Term& term : fit.terms) {
    if (!term.recipe->scales_all && !term.recipe->shifts_angle) {
      sum += torque(term);
    }
  }
  return sum;
}

Eigen::MatrixXd ModelFitter::scaled(const ModelFit& fit, Eigen::MatrixXd columns) const {
  for (const Term& term : fit.terms) {
    if (term.recipe->scales_all) {
      columns.middleRows(term.recipe->joint * data_->rows(), data_->rows()) *= 1.0 - term.c[0];
    }
  }
  passive_.apply(mechanism_->baseParameters(fit.mechanism), columns);
  return columns;
}

void ModelFitter::addDeclared(const model::ModelDescription& nominal) {
  for (const model::EffectDescription& effect : nominal.effects) {
    if (auto recipe = declaredRecipe(effect)) {
      const std::vector<double> ones(recipe->coefficients(), 1.0);
      declared_.push_back({.recipe = std::move(recipe),
                           .c = ones,
                           .nu = {},
                           .declared = true,
                           .prior_c = ones,
                           .replaced = {}});
    } else {
      fixed_.push_back(effect);
      model::DynamicsModel whole = model::makeModel({.mechanism = nominal.mechanism, .effects = {effect}});
      fixed_torque_ += data_->modelTorque(whole) - data_->modelTorque(bare_);
    }
  }
}

Eigen::MatrixXd ModelFitter::shift(int joint, double angle_rad) {
  auto found = regressor_shifts_.find(joint);
  if (found == regressor_shifts_.end()) {
    found = regressor_shifts_
                .emplace(joint, AngleShift::ofRegressor(*data_, bare_.mechanism(), joint,
                                                        model::isPrismatic(nominal_.mechanism, joint)))
                .first;
  }
  return found->second.at(angle_rad);
}

Eigen::VectorXd ModelFitter::torqueShift(int joint, double angle_rad) {
  auto found = torque_shifts_.find(joint);
  if (found == torque_shifts_.end()) {
    found = torque_shifts_
                .emplace(joint, AngleShift::ofTorque(*data_, bare_.mechanism(), joint,
                                                     model::isPrismatic(nominal_.mechanism, joint)))
                .first;
  }
  return found->second.at(angle_rad);
}

Eigen::MatrixXd ModelFitter::regressorOf(const ModelFit& fit) {
  Eigen::MatrixXd regressor = regressor_;
  for (const Term& term : fit.terms) {
    if (term.recipe->shifts_angle) {
      regressor += shift(term.recipe->joint, term.nu[0]);
    }
  }
  return regressor;
}

const Column& ModelFitter::columnOf(const Recipe& recipe, const std::vector<double>& parameters) {
  const std::string key = fmt::format("{}@{}{} {}", recipe.kind, recipe.joint,
                                      recipe.by_asked_torque ? " asked" : "", fmt::join(parameters, " "));
  if (const auto found = cache_.find(key); found != cache_.end()) {
    return found->second;
  }
  if (static_cast<Eigen::Index>(cache_.size()) * torque_.size() > kCachedNumbers) {
    cache_.clear();
  }
  const auto effect = model::makeEffect(recipe.kind, recipe.joint, bare_.mechanism(), parameters);
  return cache_
      .emplace(key, recipe.by_asked_torque ? data_->askedEffectTorque(*effect) : data_->effectTorque(*effect))
      .first->second;
}

Eigen::MatrixXd ModelFitter::basis(const Recipe& recipe, std::span<const double> nu) {
  if (recipe.scales_all) {
    // In proportion to the torque that the nominal model asks for. The recorded one holds the noise that a
    // fit is to leave, and whatever is missing: a gain of −1 would explain them all.
    const Eigen::Index rows = data_->rows();
    Eigen::MatrixXd column = Eigen::MatrixXd::Zero(torque_.size(), 1);
    column.col(0).segment(recipe.joint * rows, rows) = -nominal_torque_.segment(recipe.joint * rows, rows);
    return column;
  }
  if (recipe.shifts_angle) {
    return torqueShift(recipe.joint, nu[0]);
  }
  const auto bases = recipe.basis(nu);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(torque_.size(), static_cast<Eigen::Index>(bases.size()));
  for (std::size_t i = 0; i < bases.size(); ++i) {
    for (const BasisTerm& term : bases[i]) {
      columns.col(static_cast<Eigen::Index>(i)) += term.weight * columnOf(recipe, term.parameters);
    }
  }
  return columns;
}

// Residual and derivatives by every free parameter at the fit's present values.
void ModelFitter::linearise(ModelFit& fit) {
  const Eigen::VectorXd to_give = toGive(fit);
  fit.residual = torque_ - scaled(fit, to_give);
  fit.tangent.resize(torque_.size(), fit.prior_weight.size());
  const auto mechanisms = static_cast<Eigen::Index>(fit.mechanism.size());
  const model::BaseParameters base = mechanism_->baseParameters(fit.mechanism);
  fit.tangent.leftCols(mechanisms).noalias() = regressorOf(fit) * mechanism_->baseSlopes(fit.mechanism);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    const Eigen::MatrixXd columns = basis(*term.recipe, term.nu);
    const Eigen::VectorXd value = weighted(columns, term.c);
    const auto coefficients = static_cast<Eigen::Index>(term.c.size());
    fit.tangent.middleCols(fit.offset[t], coefficients) = columns.leftCols(coefficients);
    for (std::size_t k = 0; k < term.nu.size(); ++k) {
      const NonlinearParameter& range = term.recipe->nonlinear[k];
      std::vector<double> moved = term.nu;
      const double step = range.step > 0.0 ? range.step : 1e-3 * (range.upper - range.lower);
      moved[k] += moved[k] + step > range.upper ? -step : step;
      const Eigen::VectorXd change =
          term.recipe->shifts_angle
              ? Eigen::VectorXd(
                    (shift(term.recipe->joint, moved[0]) - shift(term.recipe->joint, term.nu[0])) * base)
              : Eigen::VectorXd(weighted(basis(*term.recipe, moved), term.c) - value);
      fit.tangent.col(fit.offset[t] + coefficients + static_cast<Eigen::Index>(k)) =
          change / (moved[k] - term.nu[k]);
    }
  }
  fit.tangent = scaled(fit, std::move(fit.tangent));
  passive_.addSlopes(base, mechanism_->baseSlopes(fit.mechanism), to_give, fit.tangent.leftCols(mechanisms));
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    if (fit.terms[t].recipe->scales_all) {
      const Eigen::Index first = fit.terms[t].recipe->joint * data_->rows();
      fit.tangent.col(fit.offset[t]).setZero();
      fit.tangent.col(fit.offset[t]).segment(first, data_->rows()) = -to_give.segment(first, data_->rows());
    }
  }
}

void ModelFitter::solve(ModelFit& fit, const Weighting& weighting) {
  std::vector<double> parameters = Cost::gather(fit);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  Cost cost(*this, fit, weighting);
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&cost, nullptr, parameters.data());
  const auto bound = [&](Eigen::Index index, double lower, double upper) {
    problem.SetParameterLowerBound(parameters.data(), static_cast<int>(index), lower);
    problem.SetParameterUpperBound(parameters.data(), static_cast<int>(index), upper);
    double& value = parameters[static_cast<std::size_t>(index)];
    value = std::clamp(value, lower, upper);
  };
  for (std::size_t i = 0; i < fit.mechanism.size(); ++i) {
    const auto [lower, upper] = mechanism_->range(i);
    bound(static_cast<Eigen::Index>(i), lower, upper);
  }
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Recipe& recipe = *fit.terms[t].recipe;
    Eigen::Index index = fit.offset[t];
    for (std::size_t i = 0; i < fit.terms[t].c.size(); ++i) {
      bound(index++, recipe.nonnegative[i] ? 0.0 : -recipe.largest, recipe.largest);
    }
    for (std::size_t k = 0; k < fit.terms[t].nu.size(); ++k) {
      bound(index++, recipe.nonlinear[k].lower, recipe.nonlinear[k].upper);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kIterations;
  options.function_tolerance = kNoFurtherGain;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Cost::scatter(parameters, fit);
  fit.mechanism = mechanism_->settled(fit.mechanism);
}

ModelFit ModelFitter::nominal() {
  ModelFit start;
  start.mechanism.assign(mechanism_->count(), 0.0);
  start.terms = declared_;
  const Weighting weighting(*data_, unexplained(start));
  const ModelFit first = fit(std::move(start), weighting);
  return fit(first, Weighting(*data_, first.residual));
}

ModelFit ModelFitter::fit(ModelFit start, const Weighting& weighting) {
  ModelFit fit = std::move(start);
  fit.offset.clear();
  auto count = static_cast<Eigen::Index>(fit.mechanism.size());
  for (const Term& term : fit.terms) {
    fit.offset.push_back(count);
    count += static_cast<Eigen::Index>(term.c.size() + term.nu.size());
  }
  fit.prior_weight = Eigen::VectorXd::Zero(count);
  fit.prior_weight.head(static_cast<Eigen::Index>(fit.mechanism.size()))
      .setConstant(1.0 / options_.nominal_tolerance);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    fit.prior_weight.segment(fit.offset[t], static_cast<Eigen::Index>(fit.terms[t].prior_c.size()))
        .setConstant(1.0 / runaway::kTolerance);
    for (std::size_t k = 0; k < fit.terms[t].nu.size(); ++k) {
      const double spread = fit.terms[t].recipe->nonlinear[k].spread;
      fit.prior_weight[shapeIndex(fit, t, k)] = spread > 0.0 ? 1.0 / spread : 0.0;
    }
  }
  fit.prior_scale = prior_scale_;
  fit.prior_weight *= prior_scale_;
  auto current = std::make_shared<const Weighting>(weighting);
  for (int round = 0; round < kNoiseRounds; ++round) {
    solve(fit, *current);
    linearise(fit);
    current = std::make_shared<const Weighting>(weighting.rescaled(fit.residual));
  }
  fit.weighting = current;
  fit.prior_residual = -Cost::priorResiduals(fit);
  fit.objective = current->objective(fit.residual) + fit.prior_residual.squaredNorm();
  fit.at_edge = edgesOf(fit);
  return fit;
}

ModelFit ModelFitter::onWholeTorque(ModelFit fit) {
  for (Term& term : fit.terms) {
    if (term.recipe->by_asked_torque) {
      Recipe whole = *term.recipe;
      whole.by_asked_torque = false;
      whole.variant += " on the whole torque";
      term.recipe = std::make_shared<const Recipe>(std::move(whole));
    }
  }
  linearise(fit);
  return fit;
}

Eigen::VectorXd ModelFitter::torque(const Term& term) {
  return weighted(basis(*term.recipe, term.nu), term.c);
}

std::vector<double> ModelFitter::effectParameters(const Term& term) {
  return term.recipe->parameters(term.c, term.nu);
}

model::ModelDescription ModelFitter::describe(const ModelFit& fit) const {
  model::ModelDescription description{.mechanism = mechanism_->at(fit.mechanism), .effects = fixed_};
  for (const Term& term : fit.terms) {
    description.effects.push_back(
        {.kind = term.recipe->kind, .joint = term.recipe->joint, .parameters = effectParameters(term)});
  }
  return description;
}

}  // namespace patella::diagnose
