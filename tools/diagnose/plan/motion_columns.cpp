#include "tools/diagnose/plan/motion_columns.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/diagnose/effects/declared.hpp"
#include "tools/diagnose/verdict/power.hpp"

namespace patella::diagnose {
namespace {

double squared(double value) {
  return value * value;
}

// Largest value of the parameter that sizes a kind, over what its recipe's first column stands for.
double largestSize(const PlannedEffect& effect) {
  const Recipe& recipe = *effect.recipe;
  if (recipe.coefficients() == 0 && recipe.proportional) {
    return recipe.nonlinear.front().upper / std::abs(effect.nu.front());
  }
  const std::string name = mainParameter(recipe.kind);
  for (const model::EffectParameter& parameter : model::findEffect(recipe.kind)->parameters) {
    if (parameter.name == name) {
      return std::min(recipe.largest, std::max(std::abs(parameter.minimum), std::abs(parameter.maximum)));
    }
  }
  return recipe.largest;
}

}  // namespace

MotionColumns::MotionColumns(const model::ModelDescription& model, std::vector<PlannedEffect> effects,
                             double tolerance)
    : bare_(model::makeModel({.mechanism = model.mechanism, .effects = {}})),
      torque_(model),
      effects_(std::move(effects)) {
  const model::BaseParameters nominal = bare_.mechanism().baseParameters();
  std::vector<double> prior;
  for (Eigen::Index k = 0; k < nominal.size(); ++k) {
    // Nothing is known of one that the model puts at zero.
    prior.push_back(nominal[k] == 0.0 ? 0.0 : 1.0 / squared(tolerance * nominal[k]));
  }
  const auto add = [&](const Recipe& recipe, std::span<const double> nu, auto&& prior_of) {
    const auto bases = recipe.basis(nu);
    for (std::size_t i = 0; i < bases.size(); ++i) {
      for (const BasisTerm& term : bases[i]) {
        sources_.push_back(
            {.effect = model::makeEffect(recipe.kind, recipe.joint, bare_.mechanism(), term.parameters),
             .weight = term.weight,
             .column = static_cast<Eigen::Index>(prior.size())});
      }
      prior.push_back(prior_of(i));
    }
  };
  for (const model::EffectDescription& declared : model.effects) {
    const bool asked = std::any_of(effects_.begin(), effects_.end(), [&](const PlannedEffect& effect) {
      return effect.recipe->kind == declared.kind && effect.recipe->joint == declared.joint;
    });
    if (const auto recipe = declaredRecipe(declared); recipe != nullptr && !asked) {
      add(*recipe, {}, [&](std::size_t) { return 1.0 / squared(tolerance); });
    }
  }
  for (const PlannedEffect& effect : effects_) {
    main_.push_back(static_cast<Eigen::Index>(prior.size()));
    const double least = 1.0 / squared(largestSize(effect));
    add(*effect.recipe, effect.nu, [&](std::size_t i) { return i == 0 ? least : 0.0; });
    companions_.push_back(static_cast<Eigen::Index>(prior.size()) - main_.back() - 1);
  }
  prior_ = Eigen::Map<const Eigen::VectorXd>(prior.data(), static_cast<Eigen::Index>(prior.size()));
}

Eigen::MatrixXd MotionColumns::at(const JointVector& q, const JointVector& dq, const JointVector& ddq,
                                  double time_s, double step_s) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(q.size(), count());
  const model::EffectInput input{
      .q = q, .dq = dq, .torque_Nm = torque_.at(q, dq, ddq, time_s, step_s == 0.0), .time_s = time_s};
  columns.leftCols(baseParameters()) = bare_.mechanism().regressor(q, dq, ddq);
  for (Source& source : sources_) {
    if (step_s == 0.0) {
      source.effect->reset(input);
    } else {
      source.effect->advance(input, step_s);
    }
    columns.col(source.column) +=
        source.weight * (source.effect->inertia(q) * ddq - source.effect->torque(input));
  }
  return columns;
}

Eigen::MatrixXd MotionColumns::along(const SampledMotion& motion, bool in_order) {
  const Eigen::Index rows = motion.q.rows(), joints = motion.q.cols();
  Eigen::MatrixXd columns(rows * joints, count());
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::MatrixXd instant =
        at(motion.q.row(i).transpose(), motion.dq.row(i).transpose(), motion.ddq.row(i).transpose(),
           in_order ? static_cast<double>(i) * motion.step_s : 0.0, in_order && i > 0 ? motion.step_s : 0.0);
    for (Eigen::Index j = 0; j < joints; ++j) {
      columns.row(j * rows + i) = instant.row(j);
    }
  }
  return columns;
}

}  // namespace patella::diagnose
