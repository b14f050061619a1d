#include "tools/diagnose/search/friction_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Dense>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/recipe_parts.hpp"
#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/lateness.hpp"
#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {
namespace {

/// Velocities at which friction may turn round, as shares of the joint's (rms). Slower turns look like
/// viscous friction.
constexpr int kPoints = 9;
constexpr double kNarrowest = 0.002;
constexpr double kStep = 1.7;
/// Where the recording tells none: the middle.
constexpr int kUntold = kPoints / 2;
constexpr double kSlowest_rad_s = 1e-4;

double velocityRms(const Dataset& data, int joint) {
  double sum = 0.0, count = 0.0;
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      sum += state.dq[joint] * state.dq[joint];
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

bool isDryFriction(const Recipe& recipe) {
  return recipe.kind == "coulomb_friction" || recipe.kind == "asymmetric_friction" ||
         recipe.kind == "stribeck_friction";
}

// The maximum of a parabola through three points, as an offset from the middle one.
double peakOffset(double before, double at, double after) {
  const double bend = before - 2.0 * at + after;
  return bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
}

class TurnRound {
 public:
  TurnRound(ModelFitter& fitter, const ModelFit& nominal)
      : fitter_(fitter),
        nominal_(nominal),
        effects_(fitter.describe(nominal).effects),
        torque_rate_(torqueRate(fitter.data())),
        plain_(elementaryColumns(fitter.data())) {}

  double velocity(int joint) {
    const double rms = velocityRms(fitter_.data(), joint);
    const auto at = [rms](double point) {
      return std::max(kSlowest_rad_s, kNarrowest * std::pow(kStep, point) * rms);
    };
    std::array<double, kPoints> gain{};
    prepare(joint);
    for (int point = 0; point < kPoints; ++point) {
      gain[static_cast<std::size_t>(point)] = gainOf(joint, at(point));
    }
    const auto best = std::max_element(gain.begin(), gain.end());
    const auto point = static_cast<double>(best - gain.begin());
    if (best == gain.begin()) {
      return at(0.0);
    }
    if (best == gain.end() - 1) {
      return at(kUntold);
    }
    return at(point + peakOffset(best[-1], best[0], best[1]));
  }

 private:
  // What the joint leaves without its declared dry friction, and what else may take it up: the model's
  // parameters, plain effects, which may be missing as well and be larger, and a drive that is late, which
  // turns friction round late as well. How late a drive is may be known already.
  void prepare(int joint) {
    left_ = ofJoint(nominal_.residual, joint);
    Eigen::MatrixXd others(left_.size(), nominal_.tangent.cols() + 4);
    others.leftCols(nominal_.tangent.cols()) =
        nominal_.tangent.middleRows(joint * left_.size(), left_.size());
    for (std::size_t t = 0; t < nominal_.terms.size(); ++t) {
      const Term& term = nominal_.terms[t];
      if (term.recipe->joint == joint && isDryFriction(*term.recipe)) {
        left_ += ofJoint(fitter_.torque(term), joint);
        others.middleCols(nominal_.offset[t], static_cast<Eigen::Index>(term.c.size())).setZero();
      }
    }
    Eigen::Index at = nominal_.tangent.cols();
    others.col(at++) = (hasTimedDrive(joint) ? 0.0 : 1.0) * ofJoint(torque_rate_, joint);
    for (const ElementaryColumn& effect : plain_) {
      if (effect.joint == joint && effect.kind != "coulomb_friction") {
        others.col(at++) = ofJoint(effect.torque, joint);
      }
    }
    const Eigen::VectorXd length = others.colwise().norm();
    others *= (length.array() > 0.0).select(length, 1.0).cwiseInverse().matrix().asDiagonal();
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(others);
    qr.setThreshold(kSpanned);
    taken_up_ = qr.householderQ() * Eigen::MatrixXd::Identity(others.rows(), qr.rank());
    left_ -= taken_up_ * (taken_up_.transpose() * left_);
  }

  bool hasTimedDrive(int joint) const {
    return std::any_of(effects_.begin(), effects_.end(), [joint](const model::EffectDescription& effect) {
      return effect.joint == joint && isTiming(effect.kind);
    });
  }

  // Fall of the squared error with dry friction that turns round at this velocity.
  double gainOf(int joint, double velocity_rad_s) {
    Eigen::VectorXd column = ofJoint(fitter_.basis(*dryFriction(joint, velocity_rad_s), {}), joint);
    column -= taken_up_ * (taken_up_.transpose() * column);
    const double product = column.dot(left_);
    return product > 0.0 ? product * product / std::max(column.squaredNorm(), 1e-300) : 0.0;
  }

  Eigen::VectorXd ofJoint(const Eigen::MatrixXd& column, int joint) const {
    const Eigen::Index rows = fitter_.data().rows();
    return column.col(0).segment(joint * rows, rows);
  }

  ModelFitter& fitter_;
  const ModelFit& nominal_;
  std::vector<model::EffectDescription> effects_;
  Column torque_rate_;
  std::vector<ElementaryColumn> plain_;
  Eigen::VectorXd left_;
  Eigen::MatrixXd taken_up_;
};

}  // namespace

std::vector<double> frictionSmoothing(ModelFitter& fitter, const ModelFit& nominal) {
  const Dataset& data = fitter.data();
  std::vector<double> smoothing;
  TurnRound turn(fitter, nominal);
  for (int joint = 0; joint < data.joints(); ++joint) {
    smoothing.push_back(data.isStatic() ? kSlowest_rad_s : turn.velocity(joint));
  }
  return smoothing;
}

namespace {

std::optional<std::size_t> smoothingIndex(const std::string& kind) {
  const auto& parameters = model::findEffect(kind)->parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [](const auto& parameter) { return parameter.name == kSmoothing; });
  return found == parameters.end() ? std::nullopt
                                   : std::optional(static_cast<std::size_t>(found - parameters.begin()));
}

}  // namespace

std::optional<double> smoothingOf(const model::EffectDescription& effect) {
  const auto index = smoothingIndex(effect.kind);
  return index ? std::optional(effect.parameters[*index]) : std::nullopt;
}

model::ModelDescription turningRoundAt(model::ModelDescription model,
                                       std::span<const double> smoothing_rad_s) {
  for (model::EffectDescription& effect : model.effects) {
    if (const auto index = smoothingIndex(effect.kind)) {
      effect.parameters[*index] = smoothing_rad_s[static_cast<std::size_t>(effect.joint)];
    }
  }
  return model;
}

}  // namespace patella::diagnose
