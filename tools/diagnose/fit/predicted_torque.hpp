// The torque that drives give, predicted from motion: what friction and gains depend on.
#pragma once

#include <vector>

#include "core/model/dynamics_model.hpp"
#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/elementary.hpp"

namespace patella::diagnose {

/// Friction of loaded gears and a drive's gain depend on the torque that the drive gives. If a regression
/// took that torque from the measurement, it would explain the measured torque by itself. So it is predicted:
/// by the given model, refitted within its tolerances, with friction, stiffness and bias on every joint.
class TorquePrediction {
 public:
  TorquePrediction(const Dataset& train, const model::ModelDescription& model, const FitOptions& options);

  /// Sets the prediction for these recordings, fitted or held out.
  void predict(Dataset& data) const;

  /// Level of the dry friction that the joint has: as declared, within its tolerance, and found beside it.
  double dryFriction_Nm(int joint) const;

 private:
  struct Share {
    ElementaryEffect effect;
    double strength = 0.0;
  };

  JointVector elementary_Nm(const model::EffectInput& state) const;

  model::ModelDescription model_;
  std::vector<Share> shares_;
};

}  // namespace patella::diagnose
