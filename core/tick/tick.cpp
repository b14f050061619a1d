#include "core/tick/tick.hpp"

#include <stdexcept>

#include "core/signal/butterworth.hpp"

namespace patella::tick {
namespace {

constexpr int kEstimateFilterOrder = 2;

std::vector<signal::BiquadCascade> estimateFilters(const TickSettings& settings, int joints) {
  signal::BiquadCascade filter;
  if (settings.estimate_cutoff_Hz != 0.0) {
    filter =
        signal::lowPass(kEstimateFilterOrder, settings.estimate_cutoff_Hz, 1.0 / settings.encoder_period_s);
  }
  return std::vector<signal::BiquadCascade>(static_cast<std::size_t>(joints), filter);
}

void zero(control::ControlOutput& output, int joints) noexcept {
  for (JointVector* term : {&output.gravity, &output.model, &output.emg, &output.impedance,
                            &output.compensation, &output.total}) {
    term->setZero(joints);
  }
}

}  // namespace

Tick::Tick(const TickSettings& settings, model::DynamicsModel model,
           std::unique_ptr<estimation::Observer> observer, std::unique_ptr<network::AttentionLstm> network,
           const std::vector<std::string>& network_features, network::OutputKind network_output)
    : settings_(settings),
      model_(std::move(model)),
      observer_(std::move(observer)),
      network_(std::move(network)),
      features_(selectFeatures(network_features)),
      network_output_(network_output),
      velocity_(settings.velocity_cutoff_Hz),
      estimate_filter_(estimateFilters(settings, model_.joints())),
      emg_(settings.emg),
      emg_torque_(model_.joints(), settings.emg_gain_Nm),
      control_(model_.joints(), settings.gains),
      reference_(model_.joints(), settings.reference),
      limiter_(model_.joints(), settings.limits),
      states_(settings.healthy_ticks),
      network_input_(features_.size()) {
  const int joints = model_.joints();
  if (network_ && network_->outputs() != joints) {
    throw std::invalid_argument("the network has " + std::to_string(network_->outputs()) +
                                " outputs, expected " + std::to_string(joints) +
                                ", one for each joint of the model");
  }
  if (!network_ && settings.compensation == CompensationSource::kNetwork) {
    throw std::invalid_argument("compensation by the network needs a network");
  }
  for (JointVector* vector :
       {&output_.command.torque_Nm, &output_.velocity_rad_s, &output_.f_s, &output_.f_s_filtered,
        &output_.f_network, &output_.d_hat_Nm, &output_.reference.q, &output_.reference.dq,
        &output_.reference.ddq, &effect_input_.q, &effect_input_.dq, &effect_input_.torque_Nm,
        &last_command_Nm_, &previous_torque_Nm_}) {
    vector->setZero(joints);
  }
  zero(output_.control, joints);
  terms_ = model_.evaluate(effect_input_);
}

const TickOutput& Tick::step(const TickInput& input) noexcept PATELLA_NONBLOCKING {
  output_.activation = emg_.update(input.measurement.emg_mV, input.measurement.emg_steps).activation;
  output_.estimated = false;
  output_.has_network = false;
  if (input.complete && input.measurement.encoder_steps > 0) {
    estimate(input);
    if (network_) {
      estimateNetwork(input);
    }
  }
  demand(input);
  decide(input);
  return output_;
}

void Tick::estimate(const TickInput& input) noexcept {
  const Measurement& m = input.measurement;
  const double dt_s = m.encoder_steps * settings_.encoder_period_s;
  has_velocity_ = m.has_velocity;
  if (m.has_velocity) {
    output_.velocity_rad_s = m.velocity_rad_s;
  } else if (seeded_ && velocity_.velocity().allFinite()) {
    output_.velocity_rad_s = velocity_.update(m.position_rad, dt_s);
  } else {
    // First sample, or one after a position that was no number, which the filter would never forget.
    velocity_.reset(m.position_rad);
    output_.velocity_rad_s = velocity_.velocity();
  }

  effect_input_.q = m.position_rad;
  effect_input_.dq = output_.velocity_rad_s;
  effect_input_.torque_Nm = m.has_drive_torque ? m.drive_torque_Nm : last_command_Nm_;
  if (settings_.drive_torque_sampled && m.has_drive_torque) {
    const JointVector before = seeded_ ? previous_torque_Nm_ : m.drive_torque_Nm;
    effect_input_.torque_Nm = 0.5 * (before + m.drive_torque_Nm);
    previous_torque_Nm_ = m.drive_torque_Nm;
  }
  effect_input_.activation = output_.activation;
  effect_input_.time_s = input.time_s;
  if (!seeded_) {
    seed();
    return;
  }
  model_.advance(effect_input_, dt_s);
  terms_ = model_.evaluate(effect_input_);
  output_.f_s = observer_->update(observerInput(dt_s));
  for (int joint = 0; joint < joints(); ++joint) {
    output_.f_s_filtered[joint] = estimate_filter_[static_cast<std::size_t>(joint)].step(output_.f_s[joint]);
  }
  output_.d_hat_Nm = terms_.inertia * output_.f_s_filtered;
  output_.estimated = true;
}

estimation::ObserverInput Tick::observerInput(double dt_s) const noexcept {
  return {.terms = terms_,
          .q = effect_input_.q,
          .dq = effect_input_.dq,
          .torque_Nm = effect_input_.torque_Nm,
          .dt_s = dt_s,
          .has_velocity = has_velocity_,
          .model = &model_,
          .activation = effect_input_.activation,
          .time_s = effect_input_.time_s};
}

// Everything with a memory starts over at the present sample, with nothing known of f_u.
void Tick::seed() noexcept {
  model_.reset(effect_input_);
  terms_ = model_.evaluate(effect_input_);
  observer_->reset(observerInput(settings_.encoder_period_s));
  for (signal::BiquadCascade& filter : estimate_filter_) {
    filter.reset(0.0);
  }
  if (network_) {
    network_->reset();
  }
  output_.estimated = false;  // what was estimated in this tick is given up
  output_.f_s.setZero();
  output_.f_s_filtered.setZero();
  output_.f_network.setZero();
  output_.d_hat_Nm.setZero();
  seeded_ = true;
}

void Tick::estimateNetwork(const TickInput& input) noexcept {
  const JointVector emg_torque = emg_torque_.torque(output_.activation);
  const auto at = [this](int feature, int index) -> double& {
    return feature_values_[static_cast<std::size_t>(feature + index)];
  };
  for (int joint = 0; joint < joints(); ++joint) {
    at(kPosition, joint) = effect_input_.q[joint];
    at(kVelocity, joint) = effect_input_.dq[joint];
    at(kTorque, joint) = effect_input_.torque_Nm[joint];
    at(kEmgTorque, joint) = emg_torque[joint];
    at(kObserver, joint) = output_.f_s[joint];
    at(kObserverFiltered, joint) = output_.f_s_filtered[joint];
  }
  for (int channel = 0; channel < kMaxEmgChannels; ++channel) {
    at(kActivation, channel) = output_.activation[static_cast<std::size_t>(channel)];
  }
  at(kTime, 0) = input.time_s;
  for (std::size_t i = 0; i < features_.size(); ++i) {
    network_input_[i] = feature_values_[static_cast<std::size_t>(features_[i])];
  }

  const JointVector value = network_->step(network_input_);
  switch (network_output_) {
    case network::OutputKind::kAcceleration:
      output_.f_network = value;
      break;
    case network::OutputKind::kTorque:
      output_.f_network = terms_.inverse_inertia * value;
      break;
    case network::OutputKind::kAccelerationCorrection:
      output_.f_network = output_.f_s_filtered + value;
      break;
    case network::OutputKind::kTorqueCorrection:
      output_.f_network = output_.f_s_filtered + terms_.inverse_inertia * value;
      break;
  }
  output_.has_network = output_.f_network.allFinite();
}

void Tick::demand(const TickInput& input) noexcept {
  if (output_.state != safety::State::kActive) {
    output_.reference = {effect_input_.q, JointVector::Zero(joints()), JointVector::Zero(joints())};
    zero(output_.control, joints());
    return;
  }
  output_.reference = reference_.at(input.time_s - active_since_s_);
  const JointVector gravity = model_.mechanism().gravity(effect_input_.q);
  const JointVector emg_torque = emg_torque_.torque(output_.activation);
  const JointVector none = JointVector::Zero(joints());
  const JointVector& f_hat = settings_.compensation == CompensationSource::kNetwork   ? output_.f_network
                             : settings_.compensation == CompensationSource::kSampler ? output_.f_s_filtered
                                                                                      : none;
  output_.control = control_.compute(
      {terms_, gravity, output_.reference, effect_input_.q, effect_input_.dq, emg_torque, f_hat});
}

// The limiter may find faults of its own, so it comes before the state machine, and the state machine has the
// last word on whether the torque it let through may flow.
void Tick::decide(const TickInput& input) noexcept {
  const safety::LimiterOutput limited =
      limiter_.apply(output_.control.total, effect_input_.q, effect_input_.dq, settings_.period_s);
  output_.faults = input.faults | limited.faults;
  output_.limits = limited.limits;

  const safety::StateOutput decision =
      states_.step({output_.faults, input.complete && seeded_, input.measurement.operator_enable,
                    input.measurement.operator_reset});
  output_.state = decision.state;
  output_.latched = decision.latched;
  output_.first_cause = decision.first_cause;
  output_.entered_active = decision.entered_active;
  output_.entered_stop = decision.entered_stop;

  if (decision.entered_active) {
    seed();
    reference_.start(effect_input_.q);
    active_since_s_ = input.time_s;
  }
  if (decision.torque_allowed) {
    output_.command.torque_Nm = limited.torque_Nm;
  } else {
    output_.command.torque_Nm.setZero();
    limiter_.stop();
  }
  output_.command.enable = decision.torque_allowed;
  output_.command.state = static_cast<std::uint8_t>(decision.state);
  last_command_Nm_ = output_.command.torque_Nm;
}

void Tick::prepareNext() noexcept PATELLA_NONBLOCKING {
  if (network_) {
    network_->prepare();
  }
}

}  // namespace patella::tick
