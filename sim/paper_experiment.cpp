#include "sim/paper_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace patella::sim {
namespace {

constexpr double kThighMass = 2.0;
constexpr double kShankMass = 0.85;
constexpr double kThighLength = 0.20;
constexpr double kShankLength = 0.25;
constexpr double kThighCom = kThighLength / 2.0;
constexpr double kShankCom = kShankLength / 2.0;
constexpr double kThighInertia = kThighMass * kThighLength * kThighLength / 4.0;
constexpr double kShankInertia = kShankMass * kShankLength * kShankLength / 4.0;
constexpr double kFriction = 0.2;
constexpr double kGravity = 9.81;

// Band of the torque. The paper does not state it; with this one the realised |f_u| comes near the bounds
// that it quotes (2.8 and 1.3, 1.4 and 0.8 rad/s²).
constexpr double kLow_Hz = 0.3;
constexpr double kHigh_Hz = 3.0;

using Pair = Eigen::Vector2d;
using State = Eigen::Vector4d;  // hip, knee, their rates

struct Push {
  PaperExperiment experiment;
  double begun_s;
};

Pair userForce(const Push& push, double time_s) {
  const double t = push.begun_s + time_s;
  if (push.experiment == PaperExperiment::kFirst) {
    return {0.1 * t + std::cos(t), 1.0 / (t + 1.0) + std::sin(t)};
  }
  return {std::atan(t) + std::cos(t), std::sin(2.0 * t) + std::sin(0.5 * t)};
}

Pair unknownAcceleration(const Push& push, double t, double hip, double knee) {
  const Pair force = userForce(push, t);
  const double shank = hip + knee;
  const double shank_x = kShankLength * std::cos(shank);
  const double shank_y = kShankLength * std::sin(shank);
  const double foot_x = kThighLength * std::cos(hip) + shank_x;
  const double foot_y = kThighLength * std::sin(hip) + shank_y;
  return {-foot_y * force.x() - shank_y * force.y(), foot_x * force.x() + shank_x * force.y()};
}

/// Lagrange's equations in the absolute angles of thigh and shank, where the inertia matrix couples through
/// cos(shank − thigh) and only squares of rates appear; then back to the joint angles.
Pair knownAcceleration(const State& state, const Pair& torque) {
  const double thigh = state[0];
  const double shank = state[0] + state[1];
  const double thigh_rate = state[2];
  const double shank_rate = state[2] + state[3];
  const double across = kShankMass * kThighLength * kShankCom;
  const double bend = shank - thigh;

  const double thigh_inertia =
      kThighInertia + kThighMass * kThighCom * kThighCom + kShankMass * kThighLength * kThighLength;
  const double shank_inertia = kShankInertia + kShankMass * kShankCom * kShankCom;
  const double coupling = across * std::cos(bend);

  const double knee_torque = torque[1] - kFriction * state[3];
  const double hip_torque = torque[0] - kFriction * state[2];
  const double thigh_moment =
      hip_torque - knee_torque + across * std::sin(bend) * shank_rate * shank_rate -
      kGravity * (kThighMass * kThighCom + kShankMass * kThighLength) * std::cos(thigh);
  const double shank_moment = knee_torque - across * std::sin(bend) * thigh_rate * thigh_rate -
                              kGravity * kShankMass * kShankCom * std::cos(shank);

  const double determinant = thigh_inertia * shank_inertia - coupling * coupling;
  const double thigh_acceleration = (shank_inertia * thigh_moment - coupling * shank_moment) / determinant;
  const double shank_acceleration = (thigh_inertia * shank_moment - coupling * thigh_moment) / determinant;
  return {thigh_acceleration, shank_acceleration - thigh_acceleration};
}

State derivative(const Push& push, double t, const State& state, const Pair& torque) {
  State rate;
  rate << state.tail<2>(),
      knownAcceleration(state, torque) + unknownAcceleration(push, t, state[0], state[1]);
  return rate;
}

/// Fourth-order Runge–Kutta in steps of at most 0.25 ms.
State integrate(const Push& push, double t, double span, State state, const Pair& torque) {
  const int steps = std::max(1, static_cast<int>(std::ceil(span / 2.5e-4 - 1e-9)));
  const double h = span / steps;
  for (int i = 0; i < steps; ++i, t += h) {
    const State k1 = derivative(push, t, state, torque);
    const State k2 = derivative(push, t + h / 2.0, state + h / 2.0 * k1, torque);
    const State k3 = derivative(push, t + h / 2.0, state + h / 2.0 * k2, torque);
    const State k4 = derivative(push, t + h, state + h * k3, torque);
    state += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return state;
}

}  // namespace

PaperTorque::PaperTorque(double rms_Nm, double peak_Nm, std::uint64_t seed) : peak_Nm_(peak_Nm) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random](double low, double high) {
    // Written out because the standard leaves the algorithm of its distributions to the library.
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
  };
  for (Tone& tone : tones_) {
    tone.rate_rad_s = 2.0 * std::numbers::pi * uniform(kLow_Hz, kHigh_Hz);
    tone.phase_rad = uniform(0.0, 2.0 * std::numbers::pi);
  }
  std::array<double, 5000> unlimited{};  // 50 s
  for (std::size_t n = 0; n < unlimited.size(); ++n) {
    unlimited[n] = raw(0.01 * static_cast<double>(n));
  }
  // The limiter takes away some of the rms, so the gain that restores it is found by iteration.
  for (int i = 0; i < 30; ++i) {
    double power = 0.0;
    for (const double value : unlimited) {
      power += std::pow(limited(value), 2) / static_cast<double>(unlimited.size());
    }
    gain_ *= rms_Nm / std::sqrt(power);
  }
}

double PaperTorque::raw(double time_s) const {
  double sum = 0.0;
  for (const Tone& tone : tones_) {
    sum += std::sin(tone.rate_rad_s * time_s + tone.phase_rad);
  }
  return sum * std::sqrt(2.0 / kTones);
}

double PaperTorque::limited(double raw_value) const {
  return peak_Nm_ * std::tanh(gain_ * raw_value / peak_Nm_);
}

std::array<PaperTorque, 2> paperTorques(std::uint64_t seed) {
  return {PaperTorque(0.59, 1.45, 2 * seed), PaperTorque(0.28, 0.70, 2 * seed + 1)};
}

std::vector<PaperSample> runPaperExperiment(PaperExperiment experiment, double rate_Hz, double seconds,
                                            std::uint64_t seed, double begun_s) {
  const auto [hip, knee] = paperTorques(seed);
  const Push push{experiment, begun_s};
  const double dt = 1.0 / rate_Hz;
  const auto steps = static_cast<std::size_t>(std::llround(seconds * rate_Hz));

  State state(-std::numbers::pi / 2.0, 0.0, 0.0, 0.0);
  std::vector<PaperSample> samples;
  samples.reserve(steps + 1);
  const Pair start = unknownAcceleration(push, 0.0, state[0], state[1]);
  samples.push_back({0.0, state.head<2>(), state.tail<2>(), JointVector::Zero(2), start, start});
  for (std::size_t k = 1; k <= steps; ++k) {
    const double begin = static_cast<double>(k - 1) * dt;
    const double middle = begin + dt / 2.0;
    const double end = static_cast<double>(k) * dt;
    const Pair torque(hip.at(begin), knee.at(begin));
    const State half = integrate(push, begin, dt / 2.0, state, torque);
    state = integrate(push, middle, dt / 2.0, half, torque);
    samples.push_back({end, state.head<2>(), state.tail<2>(), torque,
                       unknownAcceleration(push, end, state[0], state[1]),
                       unknownAcceleration(push, middle, half[0], half[1])});
  }
  return samples;
}

}  // namespace patella::sim
