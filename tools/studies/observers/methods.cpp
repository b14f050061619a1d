#include "tools/studies/observers/methods.hpp"

#include <cmath>
#include <numbers>

#include "core/estimation/extended_state_observer.hpp"
#include "core/estimation/fixed_lag_smoother.hpp"
#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/kalman_observer.hpp"
#include "core/estimation/low_pass_observer.hpp"
#include "core/estimation/momentum_observer.hpp"
#include "core/estimation/printed_sampler.hpp"
#include "core/estimation/super_twisting_observer.hpp"
#include "core/estimation/terminal_sliding_observer.hpp"

namespace patella::study {
namespace {

using namespace estimation;
using Values = std::span<const double>;
using Disturbance = KalmanSettings::Disturbance;

constexpr int kJoints = 2;
constexpr int kLag = 100;

/// Each joint has a number of its own.
std::vector<Tunable> perJoint(const std::string& name, double start) {
  return {{name, start}, {name, start}};
}

PerJoint pair(Values v, std::size_t first) {
  PerJoint values = everyJoint(v[first + 1]);
  values[0] = v[first];
  return values;
}

/// Which Kalman filter: the space, and whether it estimates position.
enum class Filter : std::uint8_t { kAccelerationVelocity, kTorqueVelocity, kForceVelocity, kTorque, kForce };

/// Noise is told as it is; where it is nought, as too little to matter.
KalmanSettings kalmanSettings(Filter filter, Disturbance disturbance, const Condition& condition,
                              const PerJoint& density) {
  constexpr double kNegligible = 1e-5;
  const bool force = filter == Filter::kForce || filter == Filter::kForceVelocity;
  KalmanSettings s;
  s.space = filter == Filter::kAccelerationVelocity ? KalmanSettings::Space::kAcceleration
            : !force                                ? KalmanSettings::Space::kJointTorque
            : condition.corrected                   ? KalmanSettings::Space::kForce
                                                    : KalmanSettings::Space::kForceAsPrinted;
  s.disturbance = disturbance;
  s.estimate_position = filter == Filter::kTorque || filter == Filter::kForce;
  s.position_noise_rad = condition.noise == Noise::kBothStates ? kStateNoise
                         : condition.encoderOnly()
                             ? 2.0 * std::numbers::pi / std::exp2(kEncoderBits) / std::sqrt(12.0)
                             : kNegligible;
  s.velocity_noise_rad_s = kStateNoise;
  s.torque_noise_Nm = condition.encoderOnly() ? kTorqueNoise_Nm : kNegligible;
  s.disturbance_density = density;
  s.disturbance_limit = 20.0;
  return s;
}

template <typename Make>
Method filtered(const std::string& name, Make make) {
  Method method{.name = name, .tunables = perJoint("cutoff_Hz", 5.0)};
  method.make = [make](const Condition&, Values v) -> std::unique_ptr<Observer> {
    return std::make_unique<LowPassObserver>(make(), pair(v, 0), kRate_Hz);
  };
  return method;
}

Method momentum(const std::string& name, MomentumParameters::Order order) {
  Method method{.name = name, .tunables = perJoint("bandwidth_Hz", 3.0)};
  if (order == MomentumParameters::Order::kSecond) {
    const auto damping = perJoint("damping_ratio", 0.7);
    method.tunables.insert(method.tunables.end(), damping.begin(), damping.end());
  }
  method.make = [order](const Condition&, Values v) -> std::unique_ptr<Observer> {
    MomentumParameters parameters{.order = order, .bandwidth_Hz = pair(v, 0)};
    if (order == MomentumParameters::Order::kSecond) {
      parameters.damping_ratio = pair(v, 2);
    }
    return std::make_unique<MomentumObserver>(parameters);
  };
  return method;
}

Method kalman(const std::string& name, Filter filter, Disturbance disturbance) {
  Method method{.name = name, .tunables = perJoint("disturbance_density", 1.0)};
  method.takes_encoder_only = filter >= Filter::kTorque;
  method.needs_velocity = !method.takes_encoder_only;
  method.make = [=](const Condition& condition, Values v) -> std::unique_ptr<Observer> {
    return std::make_unique<KalmanObserver>(kalmanSettings(filter, disturbance, condition, pair(v, 0)),
                                            kJoints);
  };
  return method;
}

Method fixedLag(const std::string& name, Filter filter) {
  Method method = kalman(name, filter, Disturbance::kConstantRate);
  method.kind = Method::Kind::kDelayed;
  method.lag_steps = kLag;
  method.make = [filter](const Condition& condition, Values v) -> std::unique_ptr<Observer> {
    return std::make_unique<FixedLagSmoother>(
        kalmanSettings(filter, Disturbance::kConstantRate, condition, pair(v, 0)), kJoints, kLag);
  };
  return method;
}

Method smoother(const std::string& name, Filter filter) {
  Method method = kalman(name, filter, Disturbance::kConstantRate);
  method.kind = Method::Kind::kOffline;
  method.make = nullptr;
  method.settings = [filter](const Condition& condition, Values v) {
    return kalmanSettings(filter, Disturbance::kConstantRate, condition, pair(v, 0));
  };
  return method;
}

std::vector<Method> classical() {
  std::vector<Method> all;
  all.push_back(filtered("printed sampler + low-pass", [] {
    return std::make_unique<PrintedSampler>(SamplerParameters{.delta = 0.1});  // as in the paper
  }));
  all.push_back(filtered("implicit sampler + low-pass",
                         [] { return std::make_unique<ImplicitSampler>(SamplerParameters{}); }));
  all.push_back(filtered("ITSMC, saturated, + low-pass", [] {
    return std::make_unique<TerminalSlidingObserver>(TerminalSlidingParameters{});
  }));
  all.push_back(momentum("momentum, 1st order", MomentumParameters::Order::kFirst));
  all.push_back(momentum("momentum, 2nd order", MomentumParameters::Order::kSecond));
  Method extended{.name = "extended state, 3rd order", .tunables = perJoint("bandwidth_Hz", 2.0)};
  extended.needs_velocity = false;
  extended.make = [](const Condition&, Values v) -> std::unique_ptr<Observer> {
    return std::make_unique<ExtendedStateObserver>(pair(v, 0));
  };
  all.push_back(std::move(extended));
  Method twisting{.name = "super-twisting, implicit", .tunables = perJoint("rate_bound_rad_s3", 10.0)};
  const auto root_gain = perJoint("root_gain", 5.0);
  twisting.tunables.insert(twisting.tunables.end(), root_gain.begin(), root_gain.end());
  twisting.make = [](const Condition&, Values v) -> std::unique_ptr<Observer> {
    return std::make_unique<SuperTwistingObserver>(
        SuperTwistingParameters{.rate_bound = pair(v, 0), .root_gain = pair(v, 2)});
  };
  all.push_back(std::move(twisting));
  return all;
}

}  // namespace

const std::vector<Method>& methods() {
  static const std::vector<Method> all = [] {
    std::vector<Method> list = classical();
    const auto walk = Disturbance::kRandomWalk;
    const auto rate = Disturbance::kConstantRate;
    list.push_back(kalman("Kalman on velocity, accel., constant rate", Filter::kAccelerationVelocity, rate));
    list.push_back(kalman("Kalman on velocity, torque, constant rate", Filter::kTorqueVelocity, rate));
    list.push_back(kalman("Kalman on velocity, force, constant rate", Filter::kForceVelocity, rate));
    list.push_back(kalman("extended Kalman, torque, random walk", Filter::kTorque, walk));
    list.push_back(kalman("extended Kalman, torque, constant rate", Filter::kTorque, rate));
    list.push_back(kalman("extended Kalman, force, random walk", Filter::kForce, walk));
    list.push_back(kalman("extended Kalman, force, constant rate", Filter::kForce, rate));
    list.push_back(fixedLag("fixed lag 0.1 s, torque", Filter::kTorque));
    list.push_back(fixedLag("fixed lag 0.1 s, force", Filter::kForce));
    list.push_back(smoother("offline smoother, torque", Filter::kTorque));
    list.push_back(smoother("offline smoother, force", Filter::kForce));
    return list;
  }();
  return all;
}

std::vector<Tunable> tunablesOf(const Method& method, const Condition& condition) {
  std::vector<Tunable> tunables = method.tunables;
  if (condition.encoderOnly() && method.needs_velocity) {
    tunables.push_back({"velocity_cutoff_Hz", 60.0});  // as the loop has it
  }
  return tunables;
}

}  // namespace patella::study
