#include "core/tick/front_end.hpp"

#include <cmath>

#include "core/signal/butterworth.hpp"

namespace patella::tick {
namespace {

constexpr int kEstimateFilterOrder = 2;

std::vector<signal::BiquadCascade> estimateFilters(const FrontEndSettings& settings, int joints) {
  signal::BiquadCascade filter;
  if (settings.estimate_cutoff_Hz != 0.0) {
    filter =
        signal::lowPass(kEstimateFilterOrder, settings.estimate_cutoff_Hz, 1.0 / settings.encoder_period_s);
  }
  return std::vector<signal::BiquadCascade>(static_cast<std::size_t>(joints), filter);
}

}  // namespace

FrontEnd::FrontEnd(const FrontEndSettings& settings, model::DynamicsModel model,
                   std::unique_ptr<estimation::Observer> observer)
    : settings_(settings),
      model_(std::move(model)),
      observer_(std::move(observer)),
      velocity_(settings.velocity_cutoff_Hz),
      filter_(estimateFilters(settings, model_.joints())),
      emg_torque_(model_.joints(), settings.emg_gain_Nm),
      step_s_(settings.encoder_period_s) {
  for (JointVector* vector : {&state_.q, &state_.dq, &state_.torque_Nm, &estimates_.f_s,
                              &estimates_.f_s_filtered, &estimates_.d_hat_Nm, &previous_torque_Nm_}) {
    vector->setZero(joints());
  }
  settled_Nm_.fill(JointVector::Zero(joints()));
  terms_ = model_.evaluate(state_);
}

bool FrontEnd::update(const Measurement& m, const EmgArray& activation, const JointVector& commanded_Nm,
                      double time_s) noexcept PATELLA_NONBLOCKING {
  step_s_ = m.encoder_steps * settings_.encoder_period_s;
  has_velocity_ = m.has_velocity;
  if (m.has_velocity) {
    state_.dq = m.velocity_rad_s;
  } else if (started_ && velocity_.velocity().allFinite()) {
    state_.dq = velocity_.update(m.position_rad, step_s_);
  } else {
    // First sample, or one after a position that was no number, which the filter would never forget.
    velocity_.reset(m.position_rad);
    state_.dq = velocity_.velocity();
  }

  state_.q = m.position_rad;
  state_.torque_Nm = m.has_drive_torque ? m.drive_torque_Nm : commanded_Nm;
  if (settings_.drive_torque_sampled && m.has_drive_torque) {
    const JointVector before = started_ ? previous_torque_Nm_ : m.drive_torque_Nm;
    state_.torque_Nm = 0.5 * (before + m.drive_torque_Nm);
    previous_torque_Nm_ = m.drive_torque_Nm;
  }
  state_.activation = activation;
  state_.time_s = time_s;
  if (!started_) {
    restart();
    started_ = true;
    return false;
  }
  model_.advance(state_, step_s_);
  terms_ = model_.evaluate(state_);
  enter(probe_, Stage::kObserver);
  estimates_.f_s = observer_->update(observerInput());
  enter(probe_, Stage::kModel);
  for (int joint = 0; joint < joints(); ++joint) {
    estimates_.f_s_filtered[joint] = filter_[static_cast<std::size_t>(joint)].step(estimates_.f_s[joint]);
  }
  estimates_.d_hat_Nm = terms_.inertia * estimates_.f_s_filtered;
  for (std::size_t i = 0; i < settled_Nm_.size(); ++i) {
    settled_Nm_[i] += -std::expm1(-step_s_ / kRiseTimes_s[i]) * (estimates_.d_hat_Nm - settled_Nm_[i]);
  }
  return true;
}

void FrontEnd::restart() noexcept PATELLA_NONBLOCKING {
  model_.reset(state_);
  terms_ = model_.evaluate(state_);
  step_s_ = settings_.encoder_period_s;
  observer_->reset(observerInput());
  for (signal::BiquadCascade& filter : filter_) {
    filter.reset(0.0);
  }
  estimates_.f_s.setZero();
  estimates_.f_s_filtered.setZero();
  estimates_.d_hat_Nm.setZero();
  for (JointVector& settled : settled_Nm_) {
    settled.setZero();
  }
}

estimation::ObserverInput FrontEnd::observerInput() const noexcept {
  return {.terms = terms_,
          .q = state_.q,
          .dq = state_.dq,
          .torque_Nm = state_.torque_Nm,
          .dt_s = step_s_,
          .has_velocity = has_velocity_,
          .model = &model_,
          .activation = state_.activation,
          .time_s = state_.time_s};
}

void FrontEnd::features(FeatureVector& values) const noexcept PATELLA_NONBLOCKING {
  const JointVector emg_torque = emgTorque(state_.activation);
  const JointVector acceleration =
      terms_.f + terms_.inverse_inertia * state_.torque_Nm + estimates_.f_s_filtered;
  const auto at = [&values](int feature, int index) -> double& {
    return values[static_cast<std::size_t>(feature + index)];
  };
  for (int joint = 0; joint < joints(); ++joint) {
    at(kPosition, joint) = state_.q[joint];
    at(kVelocity, joint) = state_.dq[joint];
    at(kTorque, joint) = state_.torque_Nm[joint];
    at(kEmgTorque, joint) = emg_torque[joint];
    at(kObserver, joint) = estimates_.f_s[joint];
    at(kObserverFiltered, joint) = estimates_.f_s_filtered[joint];
    at(kObserverTorque, joint) = estimates_.d_hat_Nm[joint];
    at(kAcceleration, joint) = acceleration[joint];
    for (int i = 0; i < kRiseTimes; ++i) {
      at(kRise + i * kMaxJoints, joint) =
          estimates_.d_hat_Nm[joint] - settled_Nm_[static_cast<std::size_t>(i)][joint];
    }
  }
  for (int channel = 0; channel < kMaxEmgChannels; ++channel) {
    at(kActivation, channel) = state_.activation[static_cast<std::size_t>(channel)];
  }
  at(kTime, 0) = state_.time_s;
}

}  // namespace patella::tick
