// A leg that moves as its model says plus a torque that its observers do not know, sampled without noise.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/extended_state_observer.hpp"
#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/kalman_observer.hpp"
#include "core/estimation/low_pass_observer.hpp"
#include "core/estimation/momentum_observer.hpp"
#include "core/estimation/super_twisting_observer.hpp"
#include "core/estimation/terminal_sliding_observer.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "core/model/presets.hpp"

namespace patella::test {

inline constexpr double kTick_s = 1e-3;

class ObservedLeg {
 public:
  /// Joint torque, N·m, that nobody knows, at a time and posture.
  using Unknown = std::function<JointVector(double time_s, const JointVector& q)>;

  ObservedLeg(const model::DynamicsModel& model, JointVector q)
      : model_(&model), q_(std::move(q)), dq_(JointVector::Zero(q_.size())), wanted_q_(q_) {}

  /// Stiff and damped towards this posture from now on.
  void hold(const JointVector& q) { wanted_q_ = q; }

  /// One tick; what the observers get of it.
  estimation::ObserverInput step(const Unknown& unknown) {
    const JointVector torque = 20.0 * (wanted_q_ - q_) - 2.0 * dq_ + model_->mechanism().gravity(wanted_q_);
    constexpr int kSteps = 4;
    const double h = kTick_s / kSteps;
    for (int i = 0; i < kSteps; ++i, time_s_ += h) {
      const auto acceleration = [&](const JointVector& q, const JointVector& dq) {
        const auto terms = model_->evaluate({.q = q, .dq = dq, .torque_Nm = torque});
        return JointVector(terms.f + terms.inverse_inertia * (torque + unknown(time_s_ + 0.5 * h, q)));
      };
      const JointVector a1 = acceleration(q_, dq_);
      const JointVector a2 = acceleration(q_ + 0.5 * h * dq_, dq_ + 0.5 * h * a1);
      q_ += h * dq_ + 0.5 * h * h * a1;
      dq_ += h * a2;
    }
    return sample(torque);
  }

  /// The present sample, under a torque.
  estimation::ObserverInput sample(const JointVector& torque) const {
    estimation::ObserverInput input{model_->evaluate({.q = q_, .dq = dq_, .torque_Nm = torque}), q_, dq_,
                                    torque, kTick_s};
    input.model = model_;
    return input;
  }

  double time_s() const { return time_s_; }
  const JointVector& q() const { return q_; }

 private:
  const model::DynamicsModel* model_;
  JointVector q_;
  JointVector dq_;
  JointVector wanted_q_;
  double time_s_ = 0.0;
};

struct NamedObserver {
  std::string name;
  std::unique_ptr<estimation::Observer> observer;
};

/// Every observer at settings for little noise; all answer within some 50 ms.
inline std::vector<NamedObserver> allObservers(int joints) {
  using namespace estimation;
  std::vector<NamedObserver> all;
  const PerJoint cutoff_Hz = everyJoint(10.0);
  all.push_back({"implicit sampler", std::make_unique<LowPassObserver>(
                                         std::make_unique<ImplicitSampler>(SamplerParameters{.delta = 30.0}),
                                         cutoff_Hz, 1.0 / kTick_s)});
  all.push_back(
      {"terminal sliding", std::make_unique<LowPassObserver>(
                               std::make_unique<TerminalSlidingObserver>(TerminalSlidingParameters{}),
                               cutoff_Hz, 1.0 / kTick_s)});
  for (const auto order : {MomentumParameters::Order::kFirst, MomentumParameters::Order::kSecond}) {
    all.push_back(
        {order == MomentumParameters::Order::kFirst ? "momentum 1" : "momentum 2",
         std::make_unique<MomentumObserver>(MomentumParameters{.order = order, .bandwidth_Hz = cutoff_Hz})});
  }
  all.push_back({"extended state", std::make_unique<ExtendedStateObserver>(cutoff_Hz)});
  all.push_back({"super-twisting", std::make_unique<SuperTwistingObserver>(SuperTwistingParameters{
                                       .rate_bound = everyJoint(2000.0), .root_gain = everyJoint(150.0)})});
  for (const auto space : {KalmanSettings::Space::kJointTorque, KalmanSettings::Space::kForce}) {
    for (const auto disturbance :
         {KalmanSettings::Disturbance::kRandomWalk, KalmanSettings::Disturbance::kConstantRate}) {
      const bool walk = disturbance == KalmanSettings::Disturbance::kRandomWalk;
      const double density = walk ? 3.0 : 100.0;
      const KalmanSettings settings{.space = space,
                                    .disturbance = disturbance,
                                    .position_noise_rad = 1e-5,
                                    .velocity_noise_rad_s = 1e-3,
                                    .torque_noise_Nm = 1e-3,
                                    .disturbance_density = everyJoint(density)};
      all.push_back({std::string("Kalman ") + (space == KalmanSettings::Space::kForce ? "force" : "torque") +
                         (walk ? ", random walk" : ", constant rate"),
                     std::make_unique<KalmanObserver>(settings, joints)});
    }
  }
  return all;
}

}  // namespace patella::test
