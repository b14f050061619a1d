#include "core/tick/tick.hpp"

#include <stdexcept>

namespace patella::tick {
namespace {

// Joints that the controller holds to the reference.
std::array<bool, kMaxJoints> stiffJoints(const control::ControlGains& gains, int joints) {
  std::array<bool, kMaxJoints> stiff{};
  for (int joint = 0; joint < joints && joint < gains.stiffness_Nm_rad.size(); ++joint) {
    stiff[static_cast<std::size_t>(joint)] = gains.stiffness_Nm_rad[joint] > 0.0;
  }
  return stiff;
}

// Electrodes whose signal becomes torque. With bypass the signal is no EMG and may do what it likes.
std::array<bool, kMaxEmgChannels> usedElectrodes(const TickSettings& settings, int joints) {
  std::array<bool, kMaxEmgChannels> used{};
  for (std::size_t channel = 0; channel < used.size(); ++channel) {
    for (std::size_t joint = 0; joint < static_cast<std::size_t>(joints); ++joint) {
      used[channel] = used[channel] || settings.emg_gain_Nm[joint][channel] != 0.0;
    }
    used[channel] = used[channel] && settings.gains.emg != 0.0 && !settings.emg.bypass;
  }
  return used;
}

const safety::MonitorSettings& checked(const safety::MonitorSettings& settings) {
  safety::requireSound(settings);
  return settings;
}

constexpr std::array kTerms{&control::ControlOutput::gravity,      &control::ControlOutput::model,
                            &control::ControlOutput::emg,          &control::ControlOutput::impedance,
                            &control::ControlOutput::compensation, &control::ControlOutput::total};

void zero(control::ControlOutput& output, int joints) noexcept {
  for (const auto term : kTerms) {
    (output.*term).setZero(joints);
  }
}

void takeJoint(const control::ControlOutput& from, Eigen::Index joint, control::ControlOutput& to) noexcept {
  for (const auto term : kTerms) {
    (to.*term)[joint] = (from.*term)[joint];
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
      features_(selectFeatures(network_features, front_.joints())),
      network_output_(network_output),
      emg_(settings.emg),
      control_(front_.joints(), settings.gains),
      reference_(front_.joints(), settings.reference),
      anticipation_(front_.joints(), front_.model().driveLateness(), settings.period_s),
      encoder_monitor_(front_.joints(), checked(settings.monitors).encoder),
      drive_monitor_(front_.joints(), settings.monitors.drive, settings.limits, settings.period_s),
      emg_monitor_(settings.monitors.emg, usedElectrodes(settings, front_.joints()), settings.emg.rate_Hz,
                   settings.emg.mains_Hz),
      motion_monitor_(front_.joints(), settings.monitors.motion, settings.limits,
                      stiffJoints(settings.gains, front_.joints())),
      network_monitor_(front_.joints(), settings.monitors.network, settings.limits),
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
        &output_.reference.dq, &output_.reference.ddq, &nothing_, &network_value_, &last_command_Nm_}) {
    vector->setZero(joints());
  }
  takeEstimates();
  zero(output_.control, joints());
}

const TickOutput& Tick::step(const TickInput& input) noexcept PATELLA_NONBLOCKING {
  enter(probe_, Stage::kEmg);
  output_.activation = emg_.update(input.measurement.emg_mV, input.measurement.emg_steps).activation;
  output_.estimated = false;
  output_.has_network = false;
  if (input.complete && input.measurement.encoder_steps > 0) {
    enter(probe_, Stage::kModel);
    estimate(input);
    if (network_) {
      enter(probe_, Stage::kNetworkStep);
      estimateNetwork(input.measurement.encoder_steps);
    }
  }
  enter(probe_, Stage::kControl);
  demand(input);
  enter(probe_, Stage::kSafety);
  decide(input);
  return output_;
}

void Tick::takeEstimates() noexcept {
  output_.f_s = front_.estimates().f_s;
  output_.f_s_filtered = front_.estimates().f_s_filtered;
  output_.d_hat_Nm = front_.estimates().d_hat_Nm;
}

void Tick::estimate(const TickInput& input) noexcept {
  const Measurement& m = input.measurement;
  inconsistent_ = m.has_velocity && encoder_monitor_.update(m.position_rad, m.velocity_rad_s,
                                                            m.encoder_steps * settings_.encoder_period_s);
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

// Drops the estimates of this tick.
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
  const JointVector difference_Nm = front_.terms().inertia * (output_.f_network - output_.f_s_filtered);
  network_trusted_ = network_monitor_.trusted(difference_Nm, encoder_steps * settings_.encoder_period_s);
}

// The network only ever gives way to the observer.
const JointVector& Tick::compensated() noexcept {
  switch (settings_.compensation) {
    case CompensationSource::kNone:
      return nothing_;
    case CompensationSource::kSampler:
      return output_.f_s_filtered;
    case CompensationSource::kNetwork:
      break;
  }
  return network_trusted_ ? output_.f_network : output_.f_s_filtered;
}

void Tick::demand(const TickInput& input) noexcept {
  if (output_.state != safety::State::kActive) {
    output_.reference = {front_.state().q, JointVector::Zero(joints()), JointVector::Zero(joints())};
    zero(output_.control, joints());
    return;
  }
  const double active_s = input.time_s - active_since_s_;
  output_.reference = reference_.at(active_s);
  if (anticipation_.needed()) {
    output_.control = demandAhead(active_s);
    return;
  }
  const JointVector gravity = front_.model().mechanism().gravity(front_.state().q);
  const JointVector emg_torque = front_.emgTorque(output_.activation);
  output_.control = control_.compute({front_.terms(), gravity, output_.reference, front_.state().q,
                                      front_.state().dq, emg_torque, compensated()});
}

// A late drive is told what the leg needs when the torque arrives: where all joints are then, and are to be.
control::ControlOutput Tick::demandAhead(double active_s) noexcept {
  const JointVector& f_hat = compensated();
  const JointVector emg_torque = front_.emgTorque(output_.activation);
  control::ControlOutput output;
  zero(output, joints());
  for (const double horizon_s : anticipation_.horizons_s()) {
    model::EffectInput then = front_.state();
    anticipation_.lookAhead(front_.terms(), f_hat, horizon_s, then.q, then.dq);
    const control::ControlOutput needed =
        control_.compute({horizon_s == 0.0 ? front_.terms() : front_.model().evaluate(then),
                          front_.model().mechanism().gravity(then.q), reference_.at(active_s + horizon_s),
                          then.q, then.dq, emg_torque, f_hat});
    for (Eigen::Index joint = 0; joint < joints(); ++joint) {
      if (anticipation_.lateness_s(joint) == horizon_s) {
        takeJoint(needed, joint, output);
      }
    }
  }
  // What a lagging drive needs on top is the model's, too.
  const JointVector more_Nm = anticipation_.quickening(output.total);
  output.model += more_Nm;
  output.total += more_Nm;
  return output;
}

safety::FaultSet Tick::monitor(const TickInput& input) noexcept {
  const Measurement& m = input.measurement;
  safety::FaultSet faults = emg_monitor_.update(m.emg_mV, m.emg_steps) | drive_monitor_.update(m);
  if (inconsistent_) {
    faults.add(safety::Fault::kEncoderInconsistent);
  }
  if (output_.state == safety::State::kActive) {
    const JointVector error_rad = output_.reference.q - m.position_rad;
    faults = faults | motion_monitor_.update(output_.d_hat_Nm, error_rad, settings_.period_s);
  } else {
    motion_monitor_.reset();
  }
  output_.warnings = {};
  if (network_ && !network_trusted_) {
    output_.warnings.add(safety::Warning::kNetworkFallback);
  }
  return faults;
}

// The limiter may find faults of its own, so it comes before the state machine, and the state machine has the
// last word on whether the torque it let through may flow.
void Tick::decide(const TickInput& input) noexcept {
  const safety::LimiterOutput limited =
      limiter_.apply(output_.control.total, front_.state().q, front_.state().dq, settings_.period_s);
  output_.faults = input.faults | limited.faults | monitor(input);
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
    network_monitor_.reset();
    network_trusted_ = true;
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
  drive_monitor_.commanded(output_.command);
  anticipation_.commanded(output_.command.torque_Nm);
  last_command_Nm_ = output_.command.torque_Nm;
}

void Tick::prepareNext() noexcept PATELLA_NONBLOCKING {
  if (network_) {
    network_->prepare();
  }
}

}  // namespace patella::tick
