#include "sim/emg_generator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/signal/butterworth.hpp"
#include "sim/random_streams.hpp"

namespace patella::sim {
namespace {

constexpr int kFilterOrder = 4;

signal::BiquadCascade bandFilter(const EmgOptions& options, double rate_Hz) {
  signal::BiquadCascade filter = signal::highPass(kFilterOrder, options.low_Hz, rate_Hz);
  filter.append(signal::lowPass(kFilterOrder, options.high_Hz, rate_Hz));
  return filter;
}

/// 1 / standard deviation of the filter's answer to unit white noise: Parseval over its impulse response.
double unitVarianceScale(signal::BiquadCascade filter, double low_Hz, double rate_Hz) {
  const int length = static_cast<int>(10.0 * rate_Hz / low_Hz);
  double energy = 0.0;
  for (int i = 0; i < length; ++i) {
    const double y = filter.step(i == 0 ? 1.0 : 0.0);
    energy += y * y;
  }
  return 1.0 / std::sqrt(energy);
}

void require(bool valid, std::size_t channel, const char* name, const char* expected) {
  if (!valid) {
    throw std::invalid_argument("emg channel " + std::to_string(channel + 1) + ": " + name +
                                " is out of range, expected " + expected);
  }
}

void check(const EmgChannelOptions& o, std::size_t channel, int joints) {
  require(o.amplitude_mV >= 0.0, channel, "amplitude_mV", ">= 0");
  require(o.baseline_mV >= 0.0, channel, "baseline_mV", ">= 0");
  require(o.hum_mV >= 0.0, channel, "hum_mV", ">= 0");
  require(std::isfinite(o.offset_mV), channel, "offset_mV", "a finite number");
  require(o.ramp_s >= 0.0, channel, "ramp_s", ">= 0");
  require(o.period_s > 0.0, channel, "period_s", "> 0");
  require(o.phase >= 0.0 && o.phase < 1.0, channel, "phase", "0 to 1");
  require(o.duty >= 0.0 && o.duty <= 1.0, channel, "duty", "0 to 1");
  require(o.joint >= 0 && o.joint < joints, channel, "joint", "a joint of the mechanism");
  require(o.direction == 1 || o.direction == -1, channel, "direction", "1 or -1");
  require(o.full_velocity_rad_s > 0.0, channel, "full_velocity_rad_s", "> 0");
}

/// Raised-cosine rise and fall around a plateau of one; a ramp of half the burst leaves no plateau.
double burst(const EmgChannelOptions& o, double time_s) noexcept {
  const double turns = time_s / o.period_s + o.phase;
  const double since_onset_s = (turns - std::floor(turns)) * o.period_s;
  const double length_s = o.duty * o.period_s;
  const double to_edge_s = std::min(since_onset_s, length_s - since_onset_s);
  if (to_edge_s <= 0.0) {
    return 0.0;
  }
  const double ramp_s = std::min(o.ramp_s, 0.5 * length_s);
  return to_edge_s >= ramp_s ? 1.0 : 0.5 * (1.0 - std::cos(std::numbers::pi * to_edge_s / ramp_s));
}

}  // namespace

EmgOptions scheduledEmg(double period_s) {
  EmgOptions options;
  // Agonist and antagonist half a period apart; the second pair follows the first by an eighth.
  for (const double phase : {0.0, 0.5, 0.125, 0.625}) {
    EmgChannelOptions channel;
    channel.period_s = period_s;
    channel.phase = phase;
    options.channels.push_back(channel);
  }
  return options;
}

EmgOptions movementEmg() {
  EmgOptions options;
  for (int i = 0; i < 4; ++i) {
    EmgChannelOptions channel;
    channel.pattern = EmgPattern::kMovement;
    channel.joint = i / 2;
    channel.direction = i % 2 == 0 ? 1 : -1;
    channel.ramp_s = 0.08;
    options.channels.push_back(channel);
  }
  return options;
}

EmgOptions paperEmg() {
  // Raised cosines without plateau, each muscle active 22 % of the time: rms = peak √(2 · 0.22 · 3/8).
  EmgOptions options = scheduledEmg(1.4);
  for (std::size_t i = 0; i < options.channels.size(); ++i) {
    EmgChannelOptions& channel = options.channels[i];
    channel.duty = 0.22;
    channel.ramp_s = 0.5 * channel.duty * channel.period_s;
    channel.phase = i % 2 == 0 ? 0.0 : 0.5;
  }
  return options;
}

JointVector paperTorque(const EmgArray& activation) noexcept {
  JointVector torque_Nm(2);
  torque_Nm << 1.45 * (activation[0] - activation[1]), 0.70 * (activation[2] - activation[3]);
  return torque_Nm;
}

EmgGenerator::EmgGenerator(const EmgOptions& options, double rate_Hz, int joints, std::uint64_t seed)
    : hum_rad_s_(2.0 * std::numbers::pi * options.hum_Hz), range_mV_(options.range_mV), filter_scale_(1.0) {
  if (options.channels.size() > kMaxEmgChannels) {
    throw std::invalid_argument("emg has " + std::to_string(options.channels.size()) +
                                " channels, expected at most " + std::to_string(kMaxEmgChannels));
  }
  if (!(options.range_mV > 0.0)) {
    throw std::invalid_argument("emg range_mV is " + std::to_string(options.range_mV) + ", expected > 0");
  }
  if (!(options.low_Hz > 0.0 && options.low_Hz < options.high_Hz && options.high_Hz < 0.5 * rate_Hz)) {
    throw std::invalid_argument("emg band " + std::to_string(options.low_Hz) + " to " +
                                std::to_string(options.high_Hz) +
                                " Hz, expected 0 < low_Hz < high_Hz < half the sampling rate");
  }
  const signal::BiquadCascade filter = bandFilter(options, rate_Hz);
  filter_scale_ = unitVarianceScale(filter, options.low_Hz, rate_Hz);
  channels_.reserve(options.channels.size());
  for (std::size_t i = 0; i < options.channels.size(); ++i) {
    const EmgChannelOptions& o = options.channels[i];
    check(o, i, joints);
    const double smoothing = o.ramp_s > 0.0 ? 1.0 - std::exp(-1.0 / (rate_Hz * o.ramp_s)) : 1.0;
    channels_.push_back({o, Random(seed, kEmgStream + i), filter, smoothing});
  }
}

void EmgGenerator::advance(double time_s, const JointVector& velocity_rad_s) noexcept PATELLA_NONBLOCKING {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    const EmgChannelOptions& o = channel.options;
    activation_[i] = activationOf(channel, activation_[i], time_s, velocity_rad_s);
    const double carrier = filter_scale_ * channel.filter.step(channel.random.gaussian());
    const double noise = o.baseline_mV * channel.random.gaussian();
    const double raw = activation_[i] * o.amplitude_mV * carrier + noise + o.offset_mV +
                       o.hum_mV * std::sin(hum_rad_s_ * time_s);
    signal_mV_[i] = std::clamp(raw, -range_mV_, range_mV_);
  }
}

double EmgGenerator::activationOf(const Channel& channel, double previous, double time_s,
                                  const JointVector& velocity_rad_s) const noexcept {
  const EmgChannelOptions& o = channel.options;
  if (o.pattern == EmgPattern::kSchedule) {
    return burst(o, time_s);
  }
  const double target = std::clamp(o.direction * velocity_rad_s(o.joint) / o.full_velocity_rad_s, 0.0, 1.0);
  return previous + channel.smoothing * (target - previous);
}

}  // namespace patella::sim
