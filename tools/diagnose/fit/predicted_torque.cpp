#include "tools/diagnose/fit/predicted_torque.hpp"

#include <algorithm>

#include <Eigen/Dense>

#include "core/model/effect.hpp"

namespace patella::diagnose {

TorquePrediction::TorquePrediction(const Dataset& train, const model::ModelDescription& model,
                                   const FitOptions& options) {
  ModelFitter fitter(train, model, options);
  const ModelFit fit = fitter.nominal();
  model_ = fitter.describe(fit);
  const std::vector<ElementaryEffect> effects = elementaryEffects(train);
  const std::vector<ElementaryColumn> columns = elementaryColumns(train);
  Eigen::MatrixXd torque(fit.residual.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    torque.col(static_cast<Eigen::Index>(k)) = columns[k].torque;
  }
  // A column of nothing, as friction of a joint that rests, gets no share.
  const Eigen::VectorXd strengths = torque.completeOrthogonalDecomposition().solve(fit.residual);
  for (std::size_t k = 0; k < effects.size(); ++k) {
    shares_.push_back({.effect = effects[k], .strength = strengths[static_cast<Eigen::Index>(k)]});
  }
}

JointVector TorquePrediction::elementary_Nm(const model::EffectInput& state) const {
  JointVector torque = JointVector::Zero(state.q.size());
  for (const Share& share : shares_) {
    torque[share.effect.joint] += share.strength * share.effect.torque_Nm(state);
  }
  return torque;
}

double TorquePrediction::dryFriction_Nm(int joint) const {
  double level_Nm = 0.0;
  for (const Share& share : shares_) {
    level_Nm += share.effect.joint == joint && share.effect.kind == "coulomb_friction" ? share.strength : 0.0;
  }
  for (const model::EffectDescription& effect : model_.effects) {
    if (effect.joint != joint) {
      continue;
    }
    const auto& parameters = model::findEffect(effect.kind)->parameters;
    double largest_Nm = 0.0;  // of two directions
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      largest_Nm =
          parameters[i].name.starts_with("level") ? std::max(largest_Nm, effect.parameters[i]) : largest_Nm;
    }
    level_Nm += largest_Nm;
  }
  return level_Nm;
}

void TorquePrediction::predict(Dataset& data) const {
  model::DynamicsModel bare = model::makeModel({.mechanism = model_.mechanism, .effects = {}});
  model::DynamicsModel whole = model::makeModel(model_);
  data.setPredictedTorque([&](const Series& series, std::size_t i) -> JointVector {
    // Effects that the model declares may depend on torque themselves: they get the rigid body's.
    model::EffectInput state = series.states[i];
    const JointVector elementary_Nm = this->elementary_Nm(state);
    state.torque_Nm = bare.inverseDynamics(state, series.acceleration[i]) + elementary_Nm;
    if (i == 0) {
      whole.reset(state);
    } else {
      whole.advance(state, 1.0 / series.rate_Hz);
    }
    return whole.inverseDynamics(state, series.acceleration[i]) + elementary_Nm;
  });
}

}  // namespace patella::diagnose
