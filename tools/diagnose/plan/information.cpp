#include "tools/diagnose/plan/information.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/effects/declared.hpp"
#include "tools/diagnose/verdict/power.hpp"

namespace patella::diagnose {
namespace {

/// Keeps matrices solvable where columns are alike, of a column's own information.
constexpr double kLeastInformation = 1e-9;

double square(double value) {
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

// A B⁻¹ Aᵀ taken off C, for a symmetric matrix with these blocks; B has its prior in it.
Eigen::MatrixXd schur(const Eigen::MatrixXd& whole, const std::vector<Eigen::Index>& kept,
                      const std::vector<Eigen::Index>& taken) {
  const Eigen::MatrixXd own = whole(kept, kept);
  if (taken.empty()) {
    return own;
  }
  Eigen::MatrixXd others = whole(taken, taken);
  const Eigen::VectorXd length = others.diagonal().cwiseSqrt().cwiseMax(1e-150);
  others = length.cwiseInverse().asDiagonal() * others * length.cwiseInverse().asDiagonal();
  others.diagonal().array() += kLeastInformation;
  const Eigen::MatrixXd across = length.cwiseInverse().asDiagonal() * whole(taken, kept);
  return own - across.transpose() * others.ldlt().solve(across);
}

}  // namespace

struct Information::Parts {
  Eigen::MatrixXd gram;   ///< weighted by noise, without what is known beforehand
  Eigen::MatrixXd plain;  ///< mean squares of each column on each joint: joints x columns
};

Information::Information(const model::ModelDescription& model, std::vector<PlannedEffect> effects,
                         const InformationOptions& options)
    : model_(model),
      bare_(model::makeModel({.mechanism = model.mechanism, .effects = {}})),
      torque_(model),
      effects_(std::move(effects)),
      options_(options) {
  const model::BaseParameters nominal = bare_.mechanism().baseParameters();
  std::vector<double> prior;
  for (Eigen::Index k = 0; k < nominal.size(); ++k) {
    // Nothing is known of one that the model puts at zero.
    prior.push_back(nominal[k] == 0.0 ? 0.0 : 1.0 / square(options_.nominal_tolerance * nominal[k]));
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
  for (const model::EffectDescription& declared : model_.effects) {
    const bool asked = std::any_of(effects_.begin(), effects_.end(), [&](const PlannedEffect& effect) {
      return effect.recipe->kind == declared.kind && effect.recipe->joint == declared.joint;
    });
    if (const auto recipe = declaredRecipe(declared); recipe != nullptr && !asked) {
      add(*recipe, {}, [&](std::size_t) { return 1.0 / square(options_.nominal_tolerance); });
    }
  }
  for (const PlannedEffect& effect : effects_) {
    main_.push_back(static_cast<Eigen::Index>(prior.size()));
    const double least = 1.0 / square(largestSize(effect));
    add(*effect.recipe, effect.nu, [&](std::size_t i) { return i == 0 ? least : 0.0; });
    companions_.push_back(static_cast<Eigen::Index>(prior.size()) - main_.back() - 1);
  }
  columns_ = static_cast<Eigen::Index>(prior.size());
  prior_ = Eigen::Map<const Eigen::VectorXd>(prior.data(), columns_);
}

// The rows of joint 1, then those of joint 2.
Eigen::MatrixXd Information::columnsOf(const SampledMotion& motion) {
  const Eigen::Index rows = motion.q.rows(), joints = motion.q.cols();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows * joints, columns_);
  const Eigen::Index base = bare_.mechanism().baseParameterCount();
  model::EffectInput input;
  for (Eigen::Index i = 0; i < rows; ++i) {
    input.q = motion.q.row(i).transpose();
    input.dq = motion.dq.row(i).transpose();
    input.time_s = static_cast<double>(i) * motion.step_s;
    const JointVector ddq = motion.ddq.row(i).transpose();
    input.torque_Nm = torque_.at(input.q, input.dq, ddq, input.time_s, i == 0);
    const model::Regressor regressor = bare_.mechanism().regressor(input.q, input.dq, ddq);
    for (Eigen::Index j = 0; j < joints; ++j) {
      columns.row(j * rows + i).head(base) = regressor.row(j);
    }
    for (Source& source : sources_) {
      if (i == 0) {
        source.effect->reset(input);
      } else {
        source.effect->advance(input, motion.step_s);
      }
      const JointVector torque = source.effect->inertia(input.q) * ddq - source.effect->torque(input);
      for (Eigen::Index j = 0; j < joints; ++j) {
        columns(j * rows + i, source.column) += source.weight * torque[j];
      }
    }
  }
  return columns;
}

Information::Parts Information::partsOf(const SampledMotion& motion) {
  Eigen::MatrixXd columns = columnsOf(motion);
  const Eigen::Index rows = motion.q.rows(), joints = motion.q.cols();
  Parts parts{.gram = Eigen::MatrixXd::Zero(columns_, columns_), .plain = Eigen::MatrixXd(joints, columns_)};
  for (Eigen::Index j = 0; j < joints; ++j) {
    auto own = columns.middleRows(j * rows, rows);
    parts.plain.row(j) = own.colwise().squaredNorm() / static_cast<double>(rows);
    own *= std::sqrt(kIndependent_Hz * motion.step_s) / options_.noise[static_cast<std::size_t>(j)].noise_Nm;
  }
  parts.gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  parts.gram.triangularView<Eigen::StrictlyUpper>() = parts.gram.transpose();
  return parts;
}

double Information::logDeterminant(const SampledMotion& motion) {
  Eigen::MatrixXd whole = partsOf(motion).gram;
  whole.diagonal() += prior_;
  const Eigen::Index base = bare_.mechanism().baseParameterCount();
  std::vector<Eigen::Index> asked, others;
  for (Eigen::Index k = 0; k < columns_; ++k) {
    const bool own = std::find(main_.begin(), main_.end(), k) != main_.end();
    (own || (k < base && options_.parameters) ? asked : others).push_back(k);
  }
  const Eigen::MatrixXd information = schur(whole, asked, others);
  // In units of what is known beforehand, so that the ridge means the same for all.
  Eigen::VectorXd unit = prior_(asked).cwiseSqrt();
  for (Eigen::Index k = 0; k < unit.size(); ++k) {
    unit[k] = unit[k] > 0.0 ? unit[k] : 1.0;
  }
  Eigen::MatrixXd scaled = unit.cwiseInverse().asDiagonal() * information * unit.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += kLeastInformation;
  return scaled.ldlt().vectorD().cwiseMax(kLeastInformation).array().log().sum();
}

std::vector<Revealed> Information::revealed(const SampledMotion& motion) {
  const Parts parts = partsOf(motion);
  Eigen::MatrixXd whole = parts.gram;
  whole.diagonal() += prior_;
  const Eigen::Index first_planned = effects_.empty() ? columns_ : main_.front();
  const double rows = kIndependent_Hz * motion.step_s * static_cast<double>(motion.q.size());
  const double threshold = shown::kTypicalChance + std::log(rows);
  JointVector torque_Nm = JointVector::Zero(motion.q.cols());
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    torque_Nm += torque_
                     .at(motion.q.row(i).transpose(), motion.dq.row(i).transpose(),
                         motion.ddq.row(i).transpose(), static_cast<double>(i) * motion.step_s, i == 0)
                     .cwiseAbs2();
  }
  torque_Nm = (torque_Nm / static_cast<double>(motion.q.rows())).cwiseSqrt().eval();
  std::vector<Revealed> all;
  for (std::size_t e = 0; e < effects_.size(); ++e) {
    const Recipe& recipe = *effects_[e].recipe;
    const auto joint = static_cast<std::size_t>(recipe.joint);
    std::vector<Eigen::Index> companions(static_cast<std::size_t>(companions_[e]));
    std::iota(companions.begin(), companions.end(), main_[e] + 1);
    std::vector<Eigen::Index> beside(static_cast<std::size_t>(first_planned));
    std::iota(beside.begin(), beside.end(), 0);
    beside.insert(beside.end(), companions.begin(), companions.end());
    // What is known of the effect's size is for the determinant.
    const double known = prior_[main_[e]];
    const double alone = schur(whole, {main_[e]}, companions)(0, 0) - known;
    const double left = std::max(0.0, schur(whole, {main_[e]}, beside)(0, 0) - known);
    const NoiseOfJoint& noise = options_.noise[joint];
    // As Detector::of has it: the part of the column that its companions do not give, in units of noise.
    const double share = std::sqrt(std::max(0.0, alone) / std::max(parts.gram(main_[e], main_[e]), 1e-300));
    const double unit_Nm = std::sqrt(parts.plain(recipe.joint, main_[e])) * share;
    const bool shows = left > kLeastInformation * std::max(alone, 1e-300) && unit_Nm > 0.0;
    const Detectable shape{
        .in_noise = std::sqrt(threshold / std::max(left, 1e-300)) * unit_Nm / noise.noise_Nm,
        .own_share = shows ? std::sqrt(left / alone) : 0.0,
        .unit_Nm = unit_Nm};
    const double smallest_Nm = smallestTorque_Nm(shape, threshold, noise.noise_Nm, noise.structure_Nm);
    const Strength strength =
        shows ? strengthAt(recipe, effects_[e].nu, smallest_Nm / unit_Nm) : Strength{.main = INFINITY};
    all.push_back({.kind = recipe.kind,
                   .joint = recipe.joint,
                   .parameter = mainParameter(recipe.kind),
                   .smallest_size = strength.main,
                   .parameters = strength.parameters,
                   .torque_rms_Nm = smallest_Nm,
                   .share_of_torque = smallest_Nm / torque_Nm[recipe.joint]});
  }
  return all;
}

}  // namespace patella::diagnose
