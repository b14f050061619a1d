#include "core/tick/tick.hpp"

#include <stdexcept>

namespace patella::tick {
namespace {

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
      front_({.encoder_period_s = settings.encoder_period_s,
              .velocity_cutoff_Hz = settings.velocity_cutoff_Hz,
              .estimate_cutoff_Hz = settings.estimate_cutoff_Hz,
              .drive_torque_sampled = settings.drive_torque_sampled,
              .emg_gain_Nm = settings.emg_gain_Nm},
             std::move(model), std::move(observer)),
      network_(std::move(network)),
      features_(selectFeatures(network_features)),
      network_output_(network_output),
      emg_(settings.emg),
      control_(front_.joints(), settings.gains),
      reference_(front_.joints(), settings.reference),
      limiter_(front_.joints(), settings.limits),
      states_(settings.healthy_ticks),
      network_input_(features_.size()) {
  if (network_ && network_->outputs() != joints()) {
    throw std::invalid_argument("the network has " + std::to_string(network_->outputs()) +
                                " outputs, expected " + std::to_string(joints()) +
                                ", one for each joint of the model");
  }
  if (!network_ && settings.compensation == CompensationSource::kNetwork) {
    throw std::invalid_argument("compensation by the network needs a network");
  }
  if (settings.network_stride < 1) {
    throw std::invalid_argument("network_stride: " + std::to_string(settings.network_stride) +
                                ", expected at least 1");
  }
  for (JointVector* vector :
       {&output_.command.torque_Nm, &output_.velocity_rad_s, &output_.f_network, &output_.reference.q,
        &output_.reference.dq, &output_.reference.ddq, &network_value_, &last_command_Nm_}) {
    vector->setZero(joints());
  }
  takeEstimates();
  zero(output_.control, joints());
}

const TickOutput& Tick::step(const TickInput& input) noexcept PATELLA_NONBLOCKING {
  output_.activation = emg_.update(input.measurement.emg_mV, input.measurement.emg_steps).activation;
  output_.estimated = false;
  output_.has_network = false;
  if (input.complete && input.measurement.encoder_steps > 0) {
    estimate(input);
    if (network_) {
      estimateNetwork(input.measurement.encoder_steps);
    }
  }
  demand(input);
  decide(input);
  return output_;
}

void Tick::takeEstimates() noexcept {
  output_.f_s = front_.estimates().f_s;
  output_.f_s_filtered = front_.estimates().f_s_filtered;
  output_.d_hat_Nm = front_.estimates().d_hat_Nm;
}

void Tick::estimate(const TickInput& input) noexcept {
  output_.estimated = front_.update(input.measurement, output_.activation, last_command_Nm_, input.time_s);
  output_.velocity_rad_s = front_.state().dq;
  if (output_.estimated) {
    takeEstimates();
  } else {
    forget();
  }
}

void Tick::restart() noexcept {
  front_.restart();
  forget();
}

// What was estimated in this tick is given up.
void Tick::forget() noexcept {
  takeEstimates();
  output_.estimated = false;
  output_.f_network.setZero();
  network_value_.setZero();
  samples_to_network_ = 1;
  if (network_) {
    network_->reset();
  }
}

void Tick::estimateNetwork(int encoder_steps) noexcept {
  samples_to_network_ -= encoder_steps;
  if (samples_to_network_ <= 0) {
    // Lost samples do not move its raster.
    samples_to_network_ = settings_.network_stride - (-samples_to_network_) % settings_.network_stride;
    front_.features(feature_values_);
    for (std::size_t i = 0; i < features_.size(); ++i) {
      network_input_[i] = feature_values_[static_cast<std::size_t>(features_[i])];
    }
    network_value_ = network_->step(network_input_);
  }
  const JointVector& value = network_value_;
  switch (network_output_) {
    case network::OutputKind::kAcceleration:
      output_.f_network = value;
      break;
    case network::OutputKind::kTorque:
      output_.f_network = front_.terms().inverse_inertia * value;
      break;
    case network::OutputKind::kAccelerationCorrection:
      output_.f_network = output_.f_s_filtered + value;
      break;
    case network::OutputKind::kTorqueCorrection:
      output_.f_network = output_.f_s_filtered + front_.terms().inverse_inertia * value;
      break;
  }
  output_.has_network = output_.f_network.allFinite();
}

void Tick::demand(const TickInput& input) noexcept {
  if (output_.state != safety::State::kActive) {
    output_.reference = {front_.state().q, JointVector::Zero(joints()), JointVector::Zero(joints())};
    zero(output_.control, joints());
    return;
  }
  output_.reference = reference_.at(input.time_s - active_since_s_);
  const JointVector gravity = front_.model().mechanism().gravity(front_.state().q);
  const JointVector emg_torque = front_.emgTorque(output_.activation);
  const JointVector none = JointVector::Zero(joints());
  const JointVector& f_hat = settings_.compensation == CompensationSource::kNetwork   ? output_.f_network
                             : settings_.compensation == CompensationSource::kSampler ? output_.f_s_filtered
                                                                                      : none;
  output_.control = control_.compute(
      {front_.terms(), gravity, output_.reference, front_.state().q, front_.state().dq, emg_torque, f_hat});
}

// The limiter may find faults of its own, so it comes before the state machine, and the state machine has the
// last word on whether the torque it let through may flow.
void Tick::decide(const TickInput& input) noexcept {
  const safety::LimiterOutput limited =
      limiter_.apply(output_.control.total, front_.state().q, front_.state().dq, settings_.period_s);
  output_.faults = input.faults | limited.faults;
  output_.limits = limited.limits;

  const safety::StateOutput decision =
      states_.step({output_.faults, input.complete && front_.started(), input.measurement.operator_enable,
                    input.measurement.operator_reset});
  output_.state = decision.state;
  output_.latched = decision.latched;
  output_.first_cause = decision.first_cause;
  output_.entered_active = decision.entered_active;
  output_.entered_stop = decision.entered_stop;

  if (decision.entered_active) {
    restart();
    reference_.start(front_.state().q);
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
