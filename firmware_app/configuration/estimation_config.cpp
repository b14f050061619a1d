#include "firmware_app/configuration/estimation_config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/estimation/extended_state_observer.hpp"
#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/kalman_observer.hpp"
#include "core/estimation/printed_sampler.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

/// Largest share of the encoder's rate that the cut-off takes where none is given.
constexpr double kUsualShare = 0.25;

struct Named {
  ObserverKind kind;
  std::string_view name;
};

constexpr std::array kObservers{Named{ObserverKind::kImplicitSampler, "implicit_sampler"},
                                Named{ObserverKind::kPrintedSampler, "printed_sampler"},
                                Named{ObserverKind::kTerminalSliding, "terminal_sliding"},
                                Named{ObserverKind::kMomentum, "momentum"},
                                Named{ObserverKind::kExtendedState, "extended_state"},
                                Named{ObserverKind::kSuperTwisting, "super_twisting"},
                                Named{ObserverKind::kKalmanTorque, "kalman_torque"},
                                Named{ObserverKind::kKalmanForce, "kalman_force"}};

/// Reads numbers in the order of the joints; without a fallback the key is required.
class PerJointReader {
 public:
  PerJointReader(const TomlTable& table, int joints)
      : table_(table), count_(static_cast<std::size_t>(joints)) {}

  PerJoint operator()(const Bound& bound) const {
    return filled(numbers(table_, bound, CountRange::exactly(count_)));
  }
  PerJoint operator()(const Bound& bound, const PerJoint& fallback) const {
    const std::vector<double> values(fallback.begin(),
                                     fallback.begin() + static_cast<std::ptrdiff_t>(count_));
    return filled(numbers(table_, bound, CountRange::exactly(count_), values));
  }

 private:
  static PerJoint filled(const std::vector<double>& values) {
    PerJoint result{};
    result.fill(values.back());
    std::copy(values.begin(), values.end(), result.begin());
    return result;
  }

  const TomlTable& table_;
  std::size_t count_;
};

void readExponent(const TomlTable& table, int& p0, int& q0) {
  readInteger(table, boundOf("estimation.p0"), p0);
  readInteger(table, boundOf("estimation.q0"), q0);
}

void readSampler(const TomlTable& table, estimation::SamplerParameters& s) {
  s.k_d = number(table, boundOf("estimation.k_d_1_s"), s.k_d);
  s.delta = number(table, boundOf("estimation.delta_rad_s2"), s.delta);
  s.epsilon = number(table, boundOf("estimation.epsilon"), s.epsilon);
  readExponent(table, s.p0, s.q0);
}

void readTerminalSliding(const TomlTable& table, estimation::TerminalSlidingParameters& s) {
  s.terminal_linear = number(table, boundOf("estimation.terminal_linear_1_s"), s.terminal_linear);
  s.terminal_fractional = number(table, boundOf("estimation.terminal_fractional"), s.terminal_fractional);
  readExponent(table, s.p0, s.q0);
  s.reaching = number(table, boundOf("estimation.reaching_1_s"), s.reaching);
  s.switching = number(table, boundOf("estimation.switching_rad_s2"), s.switching);
  s.boundary = number(table, boundOf("estimation.boundary_rad_s"), s.boundary);
}

void readMomentum(const TomlTable& table, const PerJointReader& perJoint, estimation::MomentumParameters& s) {
  using Order = estimation::MomentumParameters::Order;
  const bool first = table.choice("order", std::vector<std::string>{"first", "second"}, "second") == "first";
  s.order = first ? Order::kFirst : Order::kSecond;
  s.bandwidth_Hz = perJoint(boundOf("estimation.bandwidth_Hz"));
  if (!first) {
    s.damping_ratio = perJoint(boundOf("estimation.damping_ratio"), s.damping_ratio);
  }
}

void readSuperTwisting(const PerJointReader& perJoint, estimation::SuperTwistingParameters& s) {
  constexpr double kUsual = 1.5;
  s.rate_bound = perJoint(boundOf("estimation.rate_bound_rad_s3"));
  for (std::size_t i = 0; i < s.rate_bound.size(); ++i) {
    s.root_gain[i] = kUsual * std::sqrt(s.rate_bound[i]);
  }
  s.root_gain = perJoint(boundOf("estimation.root_gain"), s.root_gain);
}

void readKalman(const TomlTable& table, int joints, bool force, estimation::KalmanSettings& s) {
  using estimation::KalmanSettings;
  s.space = force ? KalmanSettings::Space::kForce : KalmanSettings::Space::kJointTorque;
  const bool walk = table.choice("disturbance", std::vector<std::string>{"random_walk", "constant_rate"},
                                 "constant_rate") == "random_walk";
  s.disturbance =
      walk ? KalmanSettings::Disturbance::kRandomWalk : KalmanSettings::Disturbance::kConstantRate;
  s.position_noise_rad = number(table, boundOf("estimation.position_noise_rad"));
  s.velocity_noise_rad_s = number(table, boundOf("estimation.velocity_noise_rad_s"), s.velocity_noise_rad_s);
  s.torque_noise_Nm = number(table, boundOf("estimation.torque_noise_Nm"));
  // A force has two components, whatever the number of joints.
  s.disturbance_density =
      PerJointReader(table, force ? 2 : joints)(boundOf("estimation.disturbance_density"));
  s.disturbance_limit = number(table, boundOf("estimation.disturbance_limit"));
  if (force) {
    s.rest_density_Nm = number(table, boundOf("estimation.rest_density_Nm"), s.rest_density_Nm);
  }
}

void requireBelowNyquist(const TomlTable& table, const char* key, double frequency_Hz, double period_s) {
  if (frequency_Hz >= 0.5 / period_s) {
    throw table.error(key, "value " + formatNumber(frequency_Hz) + ", expected less than " +
                               formatNumber(0.5 / period_s) + ", half of the encoder's rate");
  }
}

void requireBandwidth(const TomlTable& table, const PerJoint& bandwidth_Hz, double period_s) {
  requireBelowNyquist(table, "bandwidth_Hz", *std::max_element(bandwidth_Hz.begin(), bandwidth_Hz.end()),
                      period_s);
}

// Between 0, which is without, and the slowest low-pass stands none.
void requireLowPass(const TomlTable& table, const char* key, double cutoff_Hz) {
  constexpr double kSlowest_Hz = boundOf("estimation.velocity_cutoff_Hz").minimum;
  if (cutoff_Hz != 0.0 && cutoff_Hz < kSlowest_Hz) {
    throw table.error(key, "value " + formatNumber(cutoff_Hz) +
                               ", expected 0, which is without, or at least " + formatNumber(kSlowest_Hz));
  }
}

ObserverKind readKind(const TomlTable& table) {
  std::vector<std::string> names;
  for (const Named& observer : kObservers) {
    names.emplace_back(observer.name);
  }
  const std::string chosen = table.choice("observer", names, names.front());
  for (const Named& observer : kObservers) {
    if (observer.name == chosen) {
      return observer.kind;
    }
  }
  return ObserverKind::kImplicitSampler;
}

/// These answer with the sample's noise and are of use behind a low-pass only.
bool needsLowPass(ObserverKind kind) {
  return kind == ObserverKind::kImplicitSampler || kind == ObserverKind::kPrintedSampler ||
         kind == ObserverKind::kTerminalSliding;
}

}  // namespace

std::string_view observerName(ObserverKind kind) noexcept {
  for (const Named& observer : kObservers) {
    if (observer.kind == kind) {
      return observer.name;
    }
  }
  return "";
}

ObserverConfig readEstimation(const TomlTable& table, int joints, tick::TickSettings& tick) {
  ObserverConfig config;
  config.kind = readKind(table);
  const PerJointReader perJoint(table, joints);
  switch (config.kind) {
    case ObserverKind::kImplicitSampler:
    case ObserverKind::kPrintedSampler:
      readSampler(table, config.sampler);
      break;
    case ObserverKind::kTerminalSliding:
      readTerminalSliding(table, config.terminal_sliding);
      break;
    case ObserverKind::kMomentum:
      readMomentum(table, perJoint, config.momentum);
      requireBandwidth(table, config.momentum.bandwidth_Hz, tick.encoder_period_s);
      break;
    case ObserverKind::kExtendedState:
      config.extended_state_bandwidth_Hz = perJoint(boundOf("estimation.bandwidth_Hz"));
      requireBandwidth(table, config.extended_state_bandwidth_Hz, tick.encoder_period_s);
      break;
    case ObserverKind::kSuperTwisting:
      readSuperTwisting(perJoint, config.super_twisting);
      break;
    case ObserverKind::kKalmanTorque:
    case ObserverKind::kKalmanForce:
      readKalman(table, joints, config.kind == ObserverKind::kKalmanForce, config.kalman);
      break;
  }
  tick.drive_torque_sampled =
      table.choice("drive_torque", std::vector<std::string>{"held", "sampled"}, "held") == "sampled";
  const double usual_Hz = kUsualShare / tick.encoder_period_s;
  tick.velocity_cutoff_Hz =
      number(table, boundOf("estimation.velocity_cutoff_Hz"), std::min(tick.velocity_cutoff_Hz, usual_Hz));
  tick.estimate_cutoff_Hz =
      number(table, boundOf("estimation.estimate_cutoff_Hz"),
             needsLowPass(config.kind) ? std::min(tick.estimate_cutoff_Hz, usual_Hz) : 0.0);
  requireBelowNyquist(table, "velocity_cutoff_Hz", tick.velocity_cutoff_Hz, tick.encoder_period_s);
  requireLowPass(table, "estimate_cutoff_Hz", tick.estimate_cutoff_Hz);
  requireBelowNyquist(table, "estimate_cutoff_Hz", tick.estimate_cutoff_Hz, tick.encoder_period_s);
  return config;
}

std::unique_ptr<estimation::Observer> makeObserver(const ObserverConfig& config, int joints) {
  switch (config.kind) {
    case ObserverKind::kImplicitSampler:
      break;
    case ObserverKind::kPrintedSampler:
      return std::make_unique<estimation::PrintedSampler>(config.sampler);
    case ObserverKind::kTerminalSliding:
      return std::make_unique<estimation::TerminalSlidingObserver>(config.terminal_sliding);
    case ObserverKind::kMomentum:
      return std::make_unique<estimation::MomentumObserver>(config.momentum);
    case ObserverKind::kExtendedState:
      return std::make_unique<estimation::ExtendedStateObserver>(config.extended_state_bandwidth_Hz);
    case ObserverKind::kSuperTwisting:
      return std::make_unique<estimation::SuperTwistingObserver>(config.super_twisting);
    case ObserverKind::kKalmanTorque:
    case ObserverKind::kKalmanForce:
      return std::make_unique<estimation::KalmanObserver>(config.kalman, joints);
  }
  return std::make_unique<estimation::ImplicitSampler>(config.sampler);
}

}  // namespace patella::app
