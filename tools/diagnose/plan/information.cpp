#include "tools/diagnose/plan/information.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/plan/best_states.hpp"
#include "tools/diagnose/regression/resting.hpp"
#include "tools/diagnose/verdict/power.hpp"

namespace patella::diagnose {
namespace {

/// Keeps matrices solvable where columns are alike, of a column's own information.
constexpr double kLeastInformation = 1e-9;

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

// Friction that has a level holds a joint with any torque below it.
bool holdsAtRest(std::string_view kind) {
  const auto& parameters = model::findEffect(kind)->parameters;
  return std::any_of(parameters.begin(), parameters.end(),
                     [](const auto& parameter) { return parameter.name.starts_with("level"); });
}

std::vector<RestingJoint> heldAtRest(const model::ModelDescription& model,
                                     std::span<const PlannedEffect> planned,
                                     std::span<const NoiseOfJoint> noise) {
  std::set<int> joints;
  for (const model::EffectDescription& declared : model.effects) {
    if (holdsAtRest(declared.kind)) {
      joints.insert(declared.joint);
    }
  }
  for (const PlannedEffect& effect : planned) {
    if (holdsAtRest(effect.recipe->kind)) {
      joints.insert(effect.recipe->joint);
    }
  }
  std::vector<RestingJoint> held;
  for (std::size_t joint = 0; joint < noise.size(); ++joint) {
    const int number = static_cast<int>(joint);
    if (noise[joint].pushed || joints.contains(number)) {
      held.push_back({.joint = number, .pushed = noise[joint].pushed});
    }
  }
  return held;
}

// Of each instant, as a diagnosis has them.
Eigen::VectorXd weightsOf(const SampledMotion& motion, std::span<const RestingJoint> held) {
  if (held.empty()) {
    return Eigen::VectorXd::Ones(motion.q.rows());
  }
  Series series;
  series.rate_Hz = 1.0 / motion.step_s;
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    model::EffectInput state;
    state.q = motion.q.row(i).transpose();
    state.dq = motion.dq.row(i).transpose();
    series.states.push_back(state);
  }
  const std::vector<double> weights = weightsInMotion(series, held);
  return Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
}

}  // namespace

struct Information::Parts {
  Eigen::MatrixXd gram;   ///< weighted by noise, without what is known beforehand
  Eigen::MatrixXd plain;  ///< mean squares of each column on each joint: joints x columns
};

Information::Information(const model::ModelDescription& model, std::vector<PlannedEffect> effects,
                         const InformationOptions& options)
    : options_(options),
      columns_(model, std::move(effects), options.nominal_tolerance),
      held_at_rest_(heldAtRest(model, columns_.effects(), options_.noise)) {}

Information::Parts Information::partsOf(const SampledMotion& motion) {
  Eigen::MatrixXd columns = columns_.along(motion);
  const Eigen::Index rows = motion.q.rows(), joints = motion.q.cols(), count = columns_.count();
  const Eigen::ArrayXd weight = weightsOf(motion, held_at_rest_).cwiseSqrt();
  Parts parts{.gram = Eigen::MatrixXd::Zero(count, count), .plain = Eigen::MatrixXd(joints, count)};
  for (Eigen::Index j = 0; j < joints; ++j) {
    auto own = columns.middleRows(j * rows, rows);
    parts.plain.row(j) = own.colwise().squaredNorm() / static_cast<double>(rows);
    own.array().colwise() *= weight;
    own *= std::sqrt(kIndependent_Hz * motion.step_s) / options_.noise[static_cast<std::size_t>(j)].noise_Nm;
  }
  parts.gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  parts.gram.triangularView<Eigen::StrictlyUpper>() = parts.gram.transpose();
  return parts;
}

std::vector<Eigen::Index> Information::beside(std::size_t effect) const {
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(columns_.ofModel()));
  std::iota(columns.begin(), columns.end(), 0);
  for (Eigen::Index k = 1; k <= columns_.companions()[effect]; ++k) {
    columns.push_back(columns_.main()[effect] + k);
  }
  return columns;
}

// What is known of the effect's size is for the determinant.
double Information::left(const Eigen::MatrixXd& gram, std::size_t effect) const {
  Eigen::MatrixXd whole = gram;
  whole.diagonal() += columns_.prior();
  const Eigen::Index main = columns_.main()[effect];
  return std::max(0.0, schur(whole, {main}, beside(effect))(0, 0) - columns_.prior()[main]);
}

double Information::logDeterminant(const SampledMotion& motion) {
  const Eigen::VectorXd& prior = columns_.prior();
  Eigen::MatrixXd whole = partsOf(motion).gram;
  whole.diagonal() += prior;
  std::vector<Eigen::Index> asked, others;
  for (Eigen::Index k = 0; k < columns_.count(); ++k) {
    const bool own = std::find(columns_.main().begin(), columns_.main().end(), k) != columns_.main().end();
    (own || (k < columns_.baseParameters() && options_.parameters) ? asked : others).push_back(k);
  }
  const Eigen::MatrixXd information = schur(whole, asked, others);
  // In units of what is known beforehand, so that the ridge means the same for all.
  Eigen::VectorXd unit = prior(asked).cwiseSqrt();
  for (Eigen::Index k = 0; k < unit.size(); ++k) {
    unit[k] = unit[k] > 0.0 ? unit[k] : 1.0;
  }
  Eigen::MatrixXd scaled = unit.cwiseInverse().asDiagonal() * information * unit.cwiseInverse().asDiagonal();
  scaled.diagonal().array() += kLeastInformation;
  return scaled.ldlt().vectorD().cwiseMax(kLeastInformation).array().log().sum();
}

// As Detector::of has it: the part of the column that its companions do not give, in units of noise.
Information::Told Information::told(const Parts& parts, const SampledMotion& motion, std::size_t e) const {
  const int joint = effects()[e].recipe->joint;
  const Eigen::Index main = columns_.main()[e];
  std::vector<Eigen::Index> companions(static_cast<std::size_t>(columns_.companions()[e]));
  std::iota(companions.begin(), companions.end(), main + 1);
  Eigen::MatrixXd whole = parts.gram;
  whole.diagonal() += columns_.prior();
  const double alone = schur(whole, {main}, companions)(0, 0) - columns_.prior()[main];
  const double own = left(parts.gram, e);
  const NoiseOfJoint& noise = options_.noise[static_cast<std::size_t>(joint)];
  const double share = std::sqrt(std::max(0.0, alone) / std::max(parts.gram(main, main), 1e-300));
  const double unit_Nm = std::sqrt(parts.plain(joint, main)) * share;
  if (!(own > kLeastInformation * std::max(alone, 1e-300)) || !(unit_Nm > 0.0)) {
    return {};
  }
  const double threshold = shown::kTypicalChance +
                           std::log(kIndependent_Hz * motion.step_s * static_cast<double>(motion.q.size()));
  const Detectable shape{.in_noise = std::sqrt(threshold / own) * unit_Nm / noise.noise_Nm,
                         .own_share = std::sqrt(own / alone),
                         .unit_Nm = unit_Nm};
  return {.unit_Nm = unit_Nm,
          .torque_Nm = smallestTorque_Nm(shape, threshold, noise.noise_Nm, noise.structure_Nm)};
}

std::vector<Revealed> Information::revealed(const SampledMotion& motion) {
  const Parts parts = partsOf(motion);
  JointVector torque_Nm = JointVector::Zero(motion.q.cols());
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    torque_Nm += columns_.torque()
                     .at(motion.q.row(i).transpose(), motion.dq.row(i).transpose(),
                         motion.ddq.row(i).transpose(), static_cast<double>(i) * motion.step_s, i == 0)
                     .cwiseAbs2();
  }
  torque_Nm = (torque_Nm / static_cast<double>(motion.q.rows())).cwiseSqrt().eval();
  // As loads_Nm() has it (regression/joint_rest.hpp).
  const model::BaseParameters nominal = columns_.nominal();
  JointVector load_Nm = torque_Nm;
  for (Eigen::Index k = 0; k < nominal.size(); ++k) {
    load_Nm = load_Nm.cwiseMax(parts.plain.col(k).cwiseSqrt() * std::abs(nominal[k])).eval();
  }
  std::vector<Revealed> all;
  for (std::size_t e = 0; e < effects().size(); ++e) {
    const PlannedEffect& effect = effects()[e];
    const Recipe& recipe = *effect.recipe;
    const Told told = this->told(parts, motion, e);
    const double smallest_Nm = std::max(told.torque_Nm, accepted::kLeastOfLoad * load_Nm[recipe.joint]);
    const Strength strength = std::isfinite(smallest_Nm)
                                  ? strengthAt(recipe, effect.nu, smallest_Nm / told.unit_Nm)
                                  : Strength{.main = INFINITY};
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

double Information::headroom(const SampledMotion& motion, const MotionLimits& limits) {
  const Eigen::MatrixXd beyond_states = columns_.along(motion) - columns_.along(motion, false);
  const Parts parts = partsOf(motion);
  if (beyond_states.squaredNorm() > 0.0 ||
      told(parts, motion, 0).torque_Nm < revealed(motion).front().torque_rms_Nm) {
    return std::nan("");
  }
  std::vector<double> noise_Nm;
  for (const NoiseOfJoint& noise : options_.noise) {
    noise_Nm.push_back(noise.noise_Nm);
  }
  const double samples = kIndependent_Hz * motion.step_s * static_cast<double>(motion.q.rows());
  const BestStates best = bestStates(columns_, columns_.main().front(), beside(0), noise_Nm, samples, limits);
  const double own = left(parts.gram, 0);
  return own > 0.0 ? std::sqrt(best.bound / own) : std::nan("");
}

}  // namespace patella::diagnose
