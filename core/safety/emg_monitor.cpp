#include "core/safety/emg_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bounds/bounds.hpp"

namespace patella::safety {

EmgMonitor::EmgMonitor(const EmgMonitorSettings& settings, const std::array<bool, kMaxEmgChannels>& used,
                       double rate_Hz, double mains_Hz) noexcept
    : settings_(settings),
      used_(used),
      period_s_(1.0 / rate_Hz),
      mains_count_(mains_Hz > 0.0 ? 1 : kMains_Hz.size()) {
  for (std::size_t i = 0; i < mains_count_; ++i) {
    mains_[i].rad_s = 2.0 * std::numbers::pi * (mains_Hz > 0.0 ? mains_Hz : kMains_Hz[i]);
  }
  for (Channel& channel : channels_) {
    // The score begins once the signal has stood still for kStill_s.
    static_assert(boundOf("safety.emg.flat_time_s").minimum >= kStill_s);
    channel.off = LeakyScore(settings.flat_time_s - kStill_s);
    channel.saturated = LeakyScore(settings.saturation_time_s);
    channel.hum = LeakyScore(settings.hum_time_s);
  }
}

FaultSet EmgMonitor::update(const EmgArray& sample_mV, int steps) noexcept PATELLA_NONBLOCKING {
  if (steps <= 0) {
    return faults_;
  }
  const double dt_s = steps * period_s_;
  for (std::size_t i = 0; i < mains_count_; ++i) {
    Mains& mains = mains_[i];
    mains.phase_rad = std::fmod(mains.phase_rad + mains.rad_s * dt_s, 2.0 * std::numbers::pi);
    mains.cosine = std::cos(mains.phase_rad);
    mains.sine = std::sin(mains.phase_rad);
  }
  faults_ = {};
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (!used_[i]) {
      continue;
    }
    if (!std::isfinite(sample_mV[i])) {
      faults_.add(Fault::kNotFinite);
      continue;
    }
    Channel& channel = channels_[i];
    if (!started_) {
      channel.lowest_mV = channel.highest_mV = sample_mV[i];
    }
    faults_ = faults_ | judge(channel, sample_mV[i], dt_s);
  }
  started_ = true;
  return faults_;
}

FaultSet EmgMonitor::judge(Channel& channel, double sample_mV, double dt_s) const noexcept {
  FaultSet faults;
  const bool saturated = std::abs(sample_mV) >= settings_.saturation_mV;
  // One sample tells little of a long gap before it.
  const double known_s = std::min(dt_s, kBridged_s);

  channel.lowest_mV = std::min(channel.lowest_mV, sample_mV);
  channel.highest_mV = std::max(channel.highest_mV, sample_mV);
  channel.still_s += known_s;
  if (channel.highest_mV - channel.lowest_mV > settings_.flat_mV) {
    channel.lowest_mV = channel.highest_mV = sample_mV;
    channel.still_s = 0.0;
  }
  // Without a band, a value that repeats itself is not judged.
  const bool still = settings_.flat_mV > 0.0 && channel.still_s > kStill_s + kScoreSlack;
  if (channel.off.update(still && !saturated, known_s)) {
    faults.add(Fault::kEmgElectrodeOff);
  }
  if (channel.saturated.update(saturated, known_s)) {
    faults.add(Fault::kEmgSaturated);
  }

  if (channel.hum.update(hum_mV(channel, sample_mV, dt_s) > settings_.hum_mV, known_s)) {
    faults.add(Fault::kEmgHum);
  }
  return faults;
}

double EmgMonitor::hum_mV(Channel& channel, double sample_mV, double dt_s) const noexcept {
  const double kept = std::max(1.0 - dt_s / kHumFilter_s, 0.0);
  const double share = std::min(dt_s, kBridged_s) / kHumFilter_s;
  double largest_mV = 0.0;
  for (std::size_t i = 0; i < mains_count_; ++i) {
    Hum& hum = channel.hums[i];
    hum.real_mV = kept * hum.real_mV + share * sample_mV * mains_[i].cosine;
    hum.imaginary_mV = kept * hum.imaginary_mV + share * sample_mV * mains_[i].sine;
    largest_mV = std::max(largest_mV, 2.0 * std::hypot(hum.real_mV, hum.imaginary_mV));
  }
  return largest_mV;
}

}  // namespace patella::safety
