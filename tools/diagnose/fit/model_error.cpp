#include "tools/diagnose/fit/model_error.hpp"

#include <algorithm>
#include <utility>

#include "tools/diagnose/fit/simulation_error.hpp"
#include "tools/diagnose/regression/elementary.hpp"

namespace patella::diagnose {

namespace {

// What the drives have to give. A drive with a gain gives so much of what it is asked for: no prediction of
// the torque, which knew of no gain, is to be scaled.
Column neededTorque(const Dataset& data, const model::ModelDescription& model) {
  model::ModelDescription without_gains = model;
  std::erase_if(without_gains.effects,
                [](const model::EffectDescription& effect) { return effect.kind == "torque_gain"; });
  model::DynamicsModel dynamics = model::makeModel(without_gains);
  Column torque = data.modelTorque(dynamics);
  for (const model::EffectDescription& effect : model.effects) {
    if (effect.kind == "torque_gain") {
      torque.segment(effect.joint * data.rows(), data.rows()) /= 1.0 + effect.parameters.front();
    }
  }
  return torque;
}

}  // namespace

ResidualOf residualOf(const Dataset& data, const model::ModelDescription& model) {
  const Column torque = data.driveTorque();
  ResidualOf result{.rms = {}, .relative = {}, .residual = torque - neededTorque(data, model)};
  for (int joint = 0; joint < data.joints(); ++joint) {
    result.rms.push_back(jointRms(data, result.residual, joint));
    result.relative.push_back(result.rms.back() / std::max(1e-12, jointRms(data, torque, joint)));
  }
  return result;
}

ErrorMeasure errorMeasure(const Dataset& train, const std::optional<Dataset>& heldout,
                          const model::ModelDescription& model) {
  const ResidualOf fitted = residualOf(train, model);
  ErrorMeasure measure{.train_rms_Nm = fitted.rms,
                       .heldout_rms_Nm = {},
                       .train_relative = fitted.relative,
                       .heldout_relative = {},
                       .simulation_rms_rad = {}};
  if (heldout) {
    const ResidualOf unseen = residualOf(*heldout, model);
    measure.heldout_rms_Nm = unseen.rms;
    measure.heldout_relative = unseen.relative;
    if (!heldout->isStatic()) {
      SimulationError simulated = simulationError(*heldout, model, kSimulationWindow_s);
      measure.simulation_rms_rad = std::move(simulated.rms_rad);
      measure.simulated = std::move(simulated.motion);
    }
  }
  return measure;
}

void appendCurves(const Dataset& data, const model::ModelDescription& before,
                  const model::ModelDescription& after, bool heldout, std::vector<JointCurves>& curves) {
  const Column first = residualOf(data, before).residual;
  const Column second = residualOf(data, after).residual;
  const Column torque = data.driveTorque();
  curves.resize(static_cast<std::size_t>(data.joints()));
  for (int joint = 0; joint < data.joints(); ++joint) {
    JointCurves& curve = curves[static_cast<std::size_t>(joint)];
    const auto append = [&](std::vector<double>& to, const Eigen::VectorXd& values) {
      to.insert(to.end(), values.begin(), values.end());
    };
    const auto part = [&](const Column& column) -> Eigen::VectorXd {
      return column.segment(joint * data.rows(), data.rows());
    };
    append(curve.time_s, data.time_s());
    append(curve.position_rad,
           data.variable([=](const Series& s, std::size_t i) { return s.states[i].q[joint]; }));
    append(curve.velocity_rad_s,
           data.variable([=](const Series& s, std::size_t i) { return s.states[i].dq[joint]; }));
    append(curve.acceleration_rad_s2,
           data.variable([=](const Series& s, std::size_t i) { return s.acceleration[i][joint]; }));
    for (std::size_t c = 0; c < curve.activation.size(); ++c) {
      const Eigen::VectorXd activation =
          data.variable([=](const Series& series, std::size_t i) { return series.states[i].activation[c]; });
      if (activation.maxCoeff() > 0.0 || !curve.activation[c].empty()) {
        // As long as the rest, where only a later recording has this channel.
        curve.activation[c].resize(curve.torque_Nm.size());
        append(curve.activation[c], activation);
      }
    }
    append(curve.torque_Nm, part(torque));
    append(curve.residual_before_Nm, part(first));
    append(curve.residual_after_Nm, part(second));
    curve.heldout.insert(curve.heldout.end(), static_cast<std::size_t>(data.rows()), heldout);
  }
}

}  // namespace patella::diagnose
