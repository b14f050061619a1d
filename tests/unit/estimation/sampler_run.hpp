// Drives an observer through samples with known truth.
#pragma once

#include <vector>

#include "core/estimation/observer.hpp"
#include "core/model/presets.hpp"
#include "sim/paper_experiment.hpp"

namespace patella::test {

struct Error {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d maximum = Eigen::Vector2d::Zero();
};

inline estimation::ObserverInput observerInput(const model::DynamicsModel& model,
                                               const sim::PaperSample& sample, double dt_s) {
  return {.terms = model.evaluate({.q = sample.q, .dq = sample.dq, .torque_Nm = sample.torque_Nm}),
          .q = sample.q,
          .dq = sample.dq,
          .torque_Nm = sample.torque_Nm,
          .dt_s = dt_s};
}

/// |f_u − f_s| in the middle of the steps after `settling_s`, of an observer that has been reset at the first
/// sample.
inline Error followedError(estimation::Observer& observer, const std::vector<sim::PaperSample>& samples,
                           double settling_s) {
  const model::DynamicsModel model = makeModel(model::paperLeg());
  const double dt = samples[1].time_s - samples[0].time_s;
  Error error;
  int count = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const JointVector estimate = observer.update(observerInput(model, samples[k], dt));
    if (samples[k].time_s > settling_s) {
      const Eigen::Vector2d difference = (samples[k].f_u_mid_step - estimate).cwiseAbs();
      error.mean += difference;
      error.maximum = error.maximum.cwiseMax(difference);
      ++count;
    }
  }
  error.mean /= count;
  return error;
}

inline Error errorOf(estimation::Observer& observer, const std::vector<sim::PaperSample>& samples,
                     double settling_s) {
  observer.reset(observerInput(makeModel(model::paperLeg()), samples.front(), 0.0));
  return followedError(observer, samples, settling_s);
}

/// A joint at rest in the model's eyes whose velocity is what f_u makes it: dq' = f_u, I = 1, f = 0.
inline estimation::ObserverInput driftInput(const JointVector& dq, double dt_s) {
  const Eigen::Index joints = dq.size();
  return {.terms = {.inertia = JointMatrix::Identity(joints, joints),
                    .inverse_inertia = JointMatrix::Identity(joints, joints),
                    .bias_Nm = JointVector::Zero(joints),
                    .drive_Nm = JointVector::Zero(joints),
                    .f = JointVector::Zero(joints)},
          .q = JointVector::Zero(joints),
          .dq = dq,
          .torque_Nm = JointVector::Zero(joints),
          .dt_s = dt_s};
}

}  // namespace patella::test
