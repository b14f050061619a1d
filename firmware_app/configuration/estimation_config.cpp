#include "firmware_app/configuration/estimation_config.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/estimation/extended_state_observer.hpp"
#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/kalman_observer.hpp"
#include "core/estimation/printed_sampler.hpp"

namespace patella::app {
namespace {

constexpr Range kCutoff{.minimum = 0.1, .maximum = 5000.0};
constexpr Range kBandwidth{.minimum = 0.01, .maximum = 1000.0};

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

  PerJoint operator()(std::string_view key, Range range) const {
    return filled(table_.numbers(key, CountRange::exactly(count_), range));
  }
  PerJoint operator()(std::string_view key, Range range, const PerJoint& fallback) const {
    const std::vector<double> values(fallback.begin(),
                                     fallback.begin() + static_cast<std::ptrdiff_t>(count_));
    return filled(table_.numbers(key, CountRange::exactly(count_), range, values));
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
  p0 = static_cast<int>(table.integer("p0", 1, 99, p0));
  q0 = static_cast<int>(table.integer("q0", 3, 101, q0));
}

void readSampler(const TomlTable& table, estimation::SamplerParameters& s) {
  s.k_d = table.number("k_d_1_s", kPositive, s.k_d);
  s.delta = table.number("delta_rad_s2", kPositive, s.delta);
  s.epsilon = table.number("epsilon", kPositive, s.epsilon);
  readExponent(table, s.p0, s.q0);
}

void readTerminalSliding(const TomlTable& table, estimation::TerminalSlidingParameters& s) {
  s.terminal_linear = table.number("terminal_linear_1_s", kPositive, s.terminal_linear);
  s.terminal_fractional = table.number("terminal_fractional", kPositive, s.terminal_fractional);
  readExponent(table, s.p0, s.q0);
  s.reaching = table.number("reaching_1_s", kPositive, s.reaching);
  s.switching = table.number("switching_rad_s2", kPositive, s.switching);
  s.boundary = table.number("boundary_rad_s", kPositive, s.boundary);
}

void readMomentum(const TomlTable& table, const PerJointReader& perJoint, estimation::MomentumParameters& s) {
  using Order = estimation::MomentumParameters::Order;
  const bool first = table.choice("order", std::vector<std::string>{"first", "second"}, "second") == "first";
  s.order = first ? Order::kFirst : Order::kSecond;
  s.bandwidth_Hz = perJoint("bandwidth_Hz", kBandwidth);
  if (!first) {
    s.damping_ratio = perJoint("damping_ratio", Range{.minimum = 0.1, .maximum = 10.0}, s.damping_ratio);
  }
}

void readSuperTwisting(const PerJointReader& perJoint, estimation::SuperTwistingParameters& s) {
  constexpr double kUsual = 1.5;
  s.rate_bound = perJoint("rate_bound_rad_s3", kPositive);
  for (std::size_t i = 0; i < s.rate_bound.size(); ++i) {
    s.root_gain[i] = kUsual * std::sqrt(s.rate_bound[i]);
  }
  s.root_gain = perJoint("root_gain", kPositive, s.root_gain);
}

void readKalman(const TomlTable& table, int joints, bool force, estimation::KalmanSettings& s) {
  using estimation::KalmanSettings;
  s.space = force ? KalmanSettings::Space::kForce : KalmanSettings::Space::kJointTorque;
  const bool walk = table.choice("disturbance", std::vector<std::string>{"random_walk", "constant_rate"},
                                 "constant_rate") == "random_walk";
  s.disturbance =
      walk ? KalmanSettings::Disturbance::kRandomWalk : KalmanSettings::Disturbance::kConstantRate;
  s.position_noise_rad = table.number("position_noise_rad", kPositive);
  s.velocity_noise_rad_s = table.number("velocity_noise_rad_s", kPositive, s.velocity_noise_rad_s);
  s.torque_noise_Nm = table.number("torque_noise_Nm", kPositive);
  // A force has two components, whatever the number of joints.
  s.disturbance_density = PerJointReader(table, force ? 2 : joints)("disturbance_density", kPositive);
  s.disturbance_limit = table.number("disturbance_limit", kPositive);
  if (force) {
    s.rest_density_Nm = table.number("rest_density_Nm", kNotNegative, s.rest_density_Nm);
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
      break;
    case ObserverKind::kExtendedState:
      config.extended_state_bandwidth_Hz = perJoint("bandwidth_Hz", kBandwidth);
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
  tick.velocity_cutoff_Hz = table.number("velocity_cutoff_Hz", kCutoff, tick.velocity_cutoff_Hz);
  const Range below_nyquist{
      .minimum = kCutoff.minimum, .maximum = 0.5 / tick.encoder_period_s, .maximum_open = true};
  tick.estimate_cutoff_Hz = table.number("estimate_cutoff_Hz", below_nyquist,
                                         needsLowPass(config.kind) ? tick.estimate_cutoff_Hz : 0.0);
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
