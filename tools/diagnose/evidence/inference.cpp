#include "tools/diagnose/evidence/inference.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "tools/diagnose/effects/declared.hpp"
#include "tools/diagnose/evidence/thresholds.hpp"
#include "tools/diagnose/fit/physical_parameters.hpp"

namespace patella::diagnose::evidence {
namespace {

/// Torque of an effect beforehand, as a share of the load: physics has no scale of its own for machines from
/// a desk's to a leg's size.
constexpr double kUsualShare = 0.5;
/// Share of the load that no torque sensor resolves.
constexpr double kSensorShare = 1e-3;
/// Shares of the target's power with which each group of other functions starts: a likelihood of levels may
/// have several peaks, one of them where nothing is unknown.
constexpr double kMuchUnknown = 0.2;
constexpr double kLittleUnknown = 1e-4;
/// Relative, of a declared effect that is not what was declared: absent, or twice as strong.
constexpr double kUsualRunaway = 1.0;
constexpr int kFirstRounds = 30;
/// That the second start takes more: it comes from farther away.
constexpr int kMoreRounds = 6;

model::BaseParameters baseOf(const model::MechanismDescription& mechanism) {
  return model::makeModel({.mechanism = mechanism, .effects = {}}).mechanism().baseParameters();
}

}  // namespace

Inference::Inference(const Dataset& data, const Dataset& asked, const model::ModelDescription& nominal,
                     std::span<const int> channels, double nominal_tolerance, std::vector<double> noise_Nm)
    : data_(&data),
      asked_(&asked),
      nominal_(nominal),
      bare_(model::makeModel({.mechanism = nominal.mechanism, .effects = {}})),
      moments_(data),
      noise_Nm_(std::move(noise_Nm)) {
  const JointVector zero = JointVector::Zero(data.joints());
  const model::BaseParameters base = bare_.mechanism().baseParameters();
  const Eigen::MatrixXd regressor = data.regressor(bare_.mechanism(), zero);
  load_Nm_ = loads_Nm(data, bare_.mechanism());
  target_values_ = data.driveTorque() - regressor * base;
  const Eigen::MatrixXd asked_regressor = asked.regressor(bare_.mechanism(), zero);
  addMechanism(asked_regressor, nominal_tolerance);
  other_ = otherFunctions(asked, channels, fixed_columns_);
  addDeclared(nominal_tolerance);
  target_ = moments_.append(target_values_);
  const Eigen::Index other_first = moments_.append(other_.columns);
  const std::vector<Eigen::VectorXd> floor = noiseFloor(asked_regressor * base.asDiagonal());
  without_other_ = std::make_unique<Evidence>(moments_, none_, other_first, floor);
  evidence_ = std::make_unique<Evidence>(moments_, other_, other_first, floor);
  plain_ = explain({}, evidence_->usual(target_, kMuchUnknown), kFirstRounds);
  lookAt(motionFamilies(asked, nominal, channels), lasting_);
  lookAt(std::move(declared_), lasting_);
  lookAt(namelessFamilies(asked, channels), lasting_);
  renew(plain_);
}

void Inference::addFixed(const Eigen::VectorXd& column, double sd) {
  fixed_.push_back({.column = moments_.append(column), .sd = sd});
  fixed_columns_.conservativeResize(column.size(), fixed_columns_.cols() + 1);
  fixed_columns_.col(fixed_columns_.cols() - 1) = column;
}

void Inference::addMechanism(const Eigen::MatrixXd& regressor, double tolerance) {
  constexpr double kStep = 1e-4;
  model::MechanismDescription mechanism = nominal_.mechanism;
  const model::BaseParameters base = baseOf(mechanism);
  for (const PhysicalParameter& parameter : physicalParameters(mechanism)) {
    const double value = *parameter.value;
    *parameter.value = value * std::exp(kStep);
    addFixed(regressor * ((baseOf(mechanism) - base) / kStep), tolerance);
    *parameter.value = value;
  }
}

void Inference::addDeclared(double tolerance) {
  for (const model::EffectDescription& description : nominal_.effects) {
    const auto recipe = declaredRecipe(description);
    if (!recipe) {
      continue;
    }
    Eigen::MatrixXd columns(target_values_.size(), 0);
    for (const auto& terms : recipe->basis({})) {
      Column column = Column::Zero(target_values_.size());
      for (const BasisTerm& term : terms) {
        const auto effect =
            model::makeEffect(recipe->kind, recipe->joint, bare_.mechanism(), term.parameters);
        column += term.weight * asked_->effectTorque(*effect);
        target_values_ -= term.weight * data_->effectTorque(*effect);
      }
      addFixed(column, tolerance);
      columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
      columns.rightCols(1) = column;
    }
    declared_.push_back({.kind = "declared " + recipe->label(),
                         .joint = -1,
                         .nonnegative = std::vector<bool>(static_cast<std::size_t>(columns.cols()), false),
                         .sd = kUsualRunaway,
                         .columns = [columns](std::span<const double>) { return columns; },
                         .parameters = [](auto c, auto) { return std::vector<double>(c.begin(), c.end()); }});
  }
}

std::vector<Eigen::VectorXd> Inference::noiseFloor(const Eigen::MatrixXd& terms) {
  const Eigen::Index first = moments_.append(terms);
  std::vector<Eigen::VectorXd> floor;
  for (int joint = 0; joint < data_->joints(); ++joint) {
    const double sensor = std::pow(kSensorShare * load_Nm_[static_cast<std::size_t>(joint)], 2);
    Eigen::VectorXd least(moments_.bands());
    for (int b = 0; b < moments_.bands(); ++b) {
      const double largest = moments_.products(joint, b).diagonal().segment(first, terms.cols()).maxCoeff() /
                             std::max(moments_.coefficients(b), 1.0);
      least[b] = std::pow(threshold::kRigidDiscrepancy, 2) * largest + sensor;
    }
    floor.push_back(least);
  }
  return floor;
}

void Inference::lookAt(std::vector<Family> families, std::vector<Candidate>& candidates) {
  for (Family& family : families) {
    const auto shared = std::make_shared<const Family>(std::move(family));
    for (const std::vector<double>& nu : shared->grid) {
      candidates.push_back({.family = shared, .nu = nu, .first = moments_.append(shared->columns(nu))});
    }
  }
}

// What depends on the model found so far.
void Inference::renew(const Explanation& explanation) {
  changing_.clear();
  lookAt(
      driveFamilies(*asked_, std::make_shared<const LinkTorque>(linkTorque(*asked_, describe(explanation)))),
      changing_);
  lookAt(oscillatingFamilies(*data_, residual(explanation)), changing_);
}

Eigen::Index Inference::firstCoefficient(const Explanation& explanation, std::size_t effect) const {
  auto first = static_cast<Eigen::Index>(fixed_.size());
  for (std::size_t e = 0; e < effect; ++e) {
    first += explanation.effects[e].count();
  }
  return first;
}

model::ModelDescription Inference::describe(const Explanation& explanation) const {
  model::ModelDescription description = nominal_;
  Eigen::Index i = 0;
  for (const PhysicalParameter& parameter : physicalParameters(description.mechanism)) {
    const double value = *parameter.value * std::exp(explanation.posterior.mean[i++]);
    *parameter.value = std::clamp(value, parameter.bound.minimum, parameter.bound.maximum);
  }
  for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
    const Candidate& effect = explanation.effects[e];
    if (effect.family->isNamed()) {
      const double* c = explanation.posterior.mean.data() + firstCoefficient(explanation, e);
      description.effects.push_back({.kind = effect.family->kind,
                                     .joint = effect.family->joint,
                                     .parameters = effect.family->parameters(
                                         {c, static_cast<std::size_t>(effect.count())}, effect.nu)});
    }
  }
  return description;
}

// What an explanation leaves of the torque, other functions included.
Eigen::VectorXd Inference::residual(const Explanation& explanation) const {
  const Eigen::VectorXd& mean = explanation.posterior.mean;
  Eigen::VectorXd left =
      target_values_ - fixed_columns_ * mean.head(static_cast<Eigen::Index>(fixed_.size()));
  for (std::size_t e = 0; e < explanation.effects.size(); ++e) {
    const Candidate& effect = explanation.effects[e];
    left -=
        effect.family->columns(effect.nu) * mean.segment(firstCoefficient(explanation, e), effect.count());
  }
  return left;
}

double Inference::sdOf(const Candidate& candidate, Eigen::Index k) const {
  constexpr double kLeastSquare = 1e-12;
  if (candidate.family->sd > 0.0) {
    return candidate.family->sd;
  }
  double square = 0.0;
  for (int joint = 0; joint < data_->joints(); ++joint) {
    square += moments_.square(joint, candidate.first + k);
  }
  return kUsualShare * load_Nm_[static_cast<std::size_t>(candidate.family->joint)] /
         std::sqrt(std::max(square / moments_.coefficients(), kLeastSquare));
}

std::vector<Parameter> Inference::parametersOf(std::span<const Candidate> effects) const {
  std::vector<Parameter> all = fixed_;
  for (const Candidate& effect : effects) {
    for (Eigen::Index k = 0; k < effect.count(); ++k) {
      all.push_back({.column = effect.first + k, .sd = sdOf(effect, k)});
    }
  }
  return all;
}

Explanation Inference::explain(std::vector<Candidate> effects, const Levels& start, int rounds) const {
  Explanation result;
  result.effects = std::move(effects);
  const std::vector<Parameter> parameters = parametersOf(result.effects);
  result.posterior = evidence_->of(parameters, target_, start, rounds);
  Posterior quiet =
      evidence_->of(parameters, target_, evidence_->usual(target_, kLittleUnknown), rounds + kMoreRounds);
  if (quiet.score > result.posterior.score) {
    result.posterior = std::move(quiet);
  }
  result.score = result.posterior.score;
  for (std::size_t e = 0; e < result.effects.size(); ++e) {
    const Candidate& effect = result.effects[e];
    result.score -= std::log(effect.family->choices);
    for (Eigen::Index k = 0; k < effect.count(); ++k) {
      if (effect.family->nonnegative[static_cast<std::size_t>(k)]) {
        result.possible = result.possible && result.posterior.mean[firstCoefficient(result, e) + k] > 0.0;
        result.score += std::log(2.0);  // the other half of the prior is not there
      }
    }
  }
  return result;
}

std::vector<JointRest> Inference::rests(const Explanation& explanation) const {
  return jointRests(*data_, bare_.mechanism(), residual(explanation), noise_Nm_);
}

void Inference::countLooks(const Explanation& explanation) {
  std::vector<double> shares;
  for (const JointRest& rest : rests(explanation)) {
    const double noise = std::min(std::pow(rest.noise_Nm / rest.left_Nm, 2), 1.0);
    shares.push_back(noise + (1.0 - noise) * std::min(threshold::kLooks / moments_.coefficients(), 1.0));
  }
  without_other_->countAsIndependent(shares);
  evidence_->countAsIndependent(shares);
  plain_ = explain({}, plain_.posterior.levels, kFirstRounds);
}

double Inference::structure(const Explanation& explanation) const {
  const std::vector<Parameter> parameters = parametersOf(explanation.effects);
  Levels levels = explanation.posterior.levels;
  levels.other.clear();
  const double near = without_other_->of(parameters, target_, levels, kFirstRounds).score;
  const double anew =
      without_other_->of(parameters, target_, without_other_->usual(target_, 0.0), kFirstRounds).score;
  return explanation.posterior.score - std::max(near, anew);
}

std::vector<Inference::Left> Inference::left(const Explanation& explanation) const {
  std::vector<Left> all;
  for (int joint = 0; joint < data_->joints(); ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    double noise = 0.0;
    for (int b = 0; b < moments_.bands(); ++b) {
      noise += moments_.coefficients(b) * explanation.posterior.levels.noise[j][b];
    }
    Eigen::VectorXd other = Eigen::VectorXd::Zero(data_->rows());
    for (std::size_t g = 0; g < other_.groups.size(); ++g) {
      const OtherGroup& group = other_.groups[g];
      if (group.joint == joint) {
        other += other_.columns.block(joint * data_->rows(), group.first, data_->rows(),
                                      static_cast<Eigen::Index>(group.spread.size())) *
                 explanation.posterior.weights[g];
      }
    }
    all.push_back({.load_Nm = load_Nm_[j],
                   .target_Nm = std::sqrt(moments_.square(joint, target_) / moments_.coefficients()),
                   .noise_Nm = std::sqrt(noise / moments_.coefficients()),
                   .other_Nm = std::sqrt(other.squaredNorm() / static_cast<double>(other.size()))});
  }
  return all;
}

}  // namespace patella::diagnose::evidence
