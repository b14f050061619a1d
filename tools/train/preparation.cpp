#include "tools/train/preparation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/estimation/state_smoother.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/signals/signals.hpp"

namespace patella::train {
namespace {

using app::ObserverKind;
using diagnose::Recording;
using diagnose::Segment;

void perJoint(std::vector<std::string>& names, int joints, const std::string& stem, const std::string& unit) {
  for (int joint = 1; joint <= joints; ++joint) {
    names.push_back(stem + std::to_string(joint) + "_" + unit);
  }
}

/// Samples from one step of the network to the next.
Eigen::Index strideOf(double recorded_Hz, double network_Hz) {
  constexpr double kTolerance = 1e-3;
  const double stride = std::round(recorded_Hz / network_Hz);
  if (!(stride >= 1.0) || std::abs(recorded_Hz - stride * network_Hz) > kTolerance * recorded_Hz) {
    throw std::invalid_argument("rate of the network: " + app::formatNumber(network_Hz) +
                                " Hz, expected a whole part of the recording's " +
                                app::formatNumber(recorded_Hz) + " Hz");
  }
  return static_cast<Eigen::Index>(stride);
}

/// As the loop counts: what is 333 in words is a third of 1000 Hz.
double exactRate(double recorded_Hz, double network_Hz) {
  constexpr double kRounding = 1e-6;
  const double exact_Hz = recorded_Hz / static_cast<double>(strideOf(recorded_Hz, network_Hz));
  return std::abs(network_Hz - exact_Hz) <= kRounding * exact_Hz ? network_Hz : exact_Hz;
}

bool bindsVelocity(const app::RunConfig& config) {
  const auto& bindings = config.bus.map.bindings;
  return std::any_of(bindings.begin(), bindings.end(),
                     [](const can::Binding& binding) { return binding.input.starts_with("velocity_rad_s"); });
}

Rows zeroPhase(const Rows& signal, double cutoff_Hz, double rate_Hz) {
  Rows result(signal.rows(), signal.cols());
  for (Eigen::Index joint = 0; joint < signal.cols(); ++joint) {
    const Eigen::VectorXd column = signal.col(joint);
    const auto smooth = offline::zeroPhaseLowPass({column.data(), static_cast<std::size_t>(column.size())},
                                                  cutoff_Hz, rate_Hz);
    result.col(joint) = Eigen::Map<const Eigen::VectorXd>(smooth.data(), column.size());
  }
  return result;
}

Rows smoothed(const Observed& observed, const app::RunConfig& config, const PreparationOptions& options) {
  const ObserverKind kind = config.observer.kind;
  if (kind != ObserverKind::kKalmanTorque && kind != ObserverKind::kKalmanForce) {
    const double cutoff_Hz =
        options.smoothing_Hz > 0.0 ? options.smoothing_Hz : config.tick.estimate_cutoff_Hz;
    if (!(cutoff_Hz > 0.0)) {
      throw std::invalid_argument("a smoothed target needs a cutoff, expected estimate_cutoff_Hz above 0");
    }
    return zeroPhase(observed.f_s, cutoff_Hz, observed.rate_Hz);
  }
  const model::DynamicsModel model = makeModel(config.model);
  std::vector<estimation::ObserverInput> inputs = observed.inputs;
  for (estimation::ObserverInput& input : inputs) {
    input.model = &model;
  }
  const auto smooth = smoothUnknownDynamics(config.observer.kalman, inputs);
  Rows result(observed.f_s.rows(), observed.f_s.cols());
  for (Eigen::Index k = 0; k < result.rows(); ++k) {
    result.row(k) = smooth[static_cast<std::size_t>(k)].f_u.transpose();
  }
  return result;
}

Rows published(const Recording& recording, Segment rows) {
  if (recording.unknown_rad_s2[0].empty()) {
    throw std::invalid_argument(recording.name +
                                ": holds no true f_u, expected the run folder of a simulated rig");
  }
  const auto count = static_cast<Eigen::Index>(rows.end - rows.first);
  Rows truth(count, recording.joints);
  for (Eigen::Index joint = 0; joint < truth.cols(); ++joint) {
    const auto& values = recording.unknown_rad_s2[static_cast<std::size_t>(joint)];
    truth.col(joint) = Eigen::Map<const Eigen::VectorXd>(values.data() + rows.first, count);
  }
  return truth;
}

}  // namespace

const std::vector<std::string>& targetNames() {
  static const std::vector<std::string> names = {"raw", "filtered", "smoothed", "truth"};
  return names;
}

std::vector<std::string> paperFeatures(int joints) {
  std::vector<std::string> names;
  perJoint(names, joints, "q", "rad");
  perJoint(names, joints, "dq", "rad_s");
  names.emplace_back("time_s");
  return names;
}

std::vector<std::string> deployableFeatures(int joints, bool has_emg) {
  std::vector<std::string> names;
  perJoint(names, joints, "q", "rad");
  perJoint(names, joints, "dq", "rad_s");
  perJoint(names, joints, "tau", "Nm");
  for (int channel = 1; has_emg && channel <= kMaxEmgChannels; ++channel) {
    names.push_back("activation" + std::to_string(channel));
  }
  perJoint(names, joints, "f_s_filtered", "rad_s2");
  perJoint(names, joints, "d_hat", "Nm");
  perJoint(names, joints, "ddq_hat", "rad_s2");
  for (const char* rise : {"d_rise_20ms", "d_rise_60ms", "d_rise_180ms"}) {
    perJoint(names, joints, rise, "Nm");
  }
  return names;
}

tick::FrontEnd makeFrontEnd(const app::RunConfig& config) {
  const tick::TickSettings& tick = config.tick;
  return {{.encoder_period_s = tick.encoder_period_s,
           .velocity_cutoff_Hz = tick.velocity_cutoff_Hz,
           .estimate_cutoff_Hz = tick.estimate_cutoff_Hz,
           .drive_torque_sampled = tick.drive_torque_sampled,
           .emg_gain_Nm = tick.emg_gain_Nm},
          makeModel(config.model),
          makeObserver(config.observer, config.model.joints())};
}

Observed observe(tick::FrontEnd& front, const Recording& recording, Segment rows, bool has_velocity) {
  const int joints = front.joints();
  const auto count = static_cast<Eigen::Index>(rows.end - rows.first);
  Observed observed{.rate_Hz = recording.rate_Hz,
                    .features = {},
                    .inputs = {},
                    .f_s = Rows(count, joints),
                    .f_s_filtered = Rows(count, joints)};
  Measurement m;
  m.encoder_steps = 1;
  m.has_drive_torque = true;
  m.has_velocity = has_velocity;
  const auto fill = [&](JointVector& vector, const auto& signals, std::size_t row) {
    vector.resize(joints);
    for (int joint = 0; joint < joints; ++joint) {
      vector[joint] = signals[static_cast<std::size_t>(joint)][row];
    }
  };
  EmgArray activation{};
  for (std::size_t row = rows.first; row < rows.end; ++row) {
    fill(m.position_rad, recording.position_rad, row);
    if (has_velocity) {
      fill(m.velocity_rad_s, recording.velocity_rad_s, row);
    }
    // A row of the recording has the torque from its sample on, a drive's report that until its sample.
    const bool held = recording.torque_timing == diagnose::TorqueTiming::kHeld;
    fill(m.drive_torque_Nm, recording.torque_Nm, held && row > rows.first ? row - 1 : row);
    for (std::size_t channel = 0; channel < activation.size(); ++channel) {
      const auto& signal = recording.activation[channel];
      activation[channel] = signal.empty() ? 0.0 : signal[row];
    }
    front.update(m, activation, m.drive_torque_Nm, recording.time_s[row]);
    const auto k = static_cast<Eigen::Index>(row - rows.first);
    observed.f_s.row(k) = front.estimates().f_s.transpose();
    observed.f_s_filtered.row(k) = front.estimates().f_s_filtered.transpose();
    observed.inputs.push_back(front.observerInput());
    front.features(observed.features.emplace_back());
  }
  return observed;
}

Sequence makeSequence(const Observed& observed, const Rows& reference, const PreparationOptions& options) {
  const Eigen::Index stride = strideOf(observed.rate_Hz, options.rate_Hz);
  const auto ahead = static_cast<Eigen::Index>(std::llround(options.horizon_s * observed.rate_Hz));
  const Eigen::Index usable = reference.rows() - ahead;
  const tick::FeatureSelection selection =
      tick::selectFeatures(options.features, static_cast<int>(reference.cols()));
  Sequence sequence;
  sequence.rate_Hz = options.rate_Hz;
  const Eigen::Index steps = usable > 0 ? (usable - 1) / stride + 1 : 0;
  sequence.features.resize(steps, static_cast<Eigen::Index>(selection.size()));
  sequence.reference.resize(steps, reference.cols());
  sequence.observer.resize(steps, reference.cols());
  sequence.role.assign(static_cast<std::size_t>(steps), Role::kIgnored);
  for (Eigen::Index step = 0; step < steps; ++step) {
    const Eigen::Index now = step * stride;
    const Eigen::Index then = now + ahead;
    for (std::size_t i = 0; i < selection.size(); ++i) {
      sequence.features(step, static_cast<Eigen::Index>(i)) =
          observed.features[static_cast<std::size_t>(now)][static_cast<std::size_t>(selection[i])];
    }
    JointVector wanted = reference.row(then).transpose();
    JointVector known = observed.f_s_filtered.row(now).transpose();
    if (isTorque(options.output)) {
      wanted = observed.inputs[static_cast<std::size_t>(then)].terms.inertia * wanted;
      known = observed.inputs[static_cast<std::size_t>(now)].terms.inertia * known;
    }
    sequence.reference.row(step) = wanted.transpose();
    sequence.observer.row(step) = known.transpose();
  }
  return sequence;
}

std::vector<Sequence> prepare(const Recording& recording, const app::RunConfig& config,
                              const PreparationOptions& options) {
  constexpr double kRateTolerance = 0.02;
  const double expected_Hz = 1.0 / config.tick.encoder_period_s;
  if (std::abs(recording.rate_Hz - expected_Hz) > kRateTolerance * expected_Hz) {
    throw std::invalid_argument(recording.name + ": rate " + app::formatNumber(recording.rate_Hz) +
                                " Hz, expected " + app::formatNumber(expected_Hz) +
                                " Hz as encoder_period_s of " + config.bus_map_path.string() + " has it");
  }
  const double network_Hz = exactRate(expected_Hz, options.rate_Hz);
  const bool has_velocity = bindsVelocity(config) && !recording.velocity_rad_s[0].empty();
  PreparationOptions at_rate = options;
  at_rate.rate_Hz = network_Hz * recording.rate_Hz / expected_Hz;
  std::vector<Sequence> sequences;
  for (const Segment& rows : recording.segments) {
    tick::FrontEnd front = makeFrontEnd(config);
    const Observed observed = observe(front, recording, rows, has_velocity);
    const Rows reference = options.target == Target::kRaw        ? observed.f_s
                           : options.target == Target::kFiltered ? observed.f_s_filtered
                           : options.target == Target::kTruth    ? published(recording, rows)
                                                                 : smoothed(observed, config, options);
    Sequence sequence = makeSequence(observed, reference, at_rate);
    sequence.rate_Hz = network_Hz;
    sequence.name = recording.name;
    sequence.sha256 = recording.sha256;
    sequences.push_back(std::move(sequence));
  }
  return sequences;
}

}  // namespace patella::train
