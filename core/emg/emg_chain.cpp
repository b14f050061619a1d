#include "core/emg/emg_chain.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"
#include "core/signal/butterworth.hpp"

namespace patella::emg {
namespace {

constexpr int kBandOrder = 2;
constexpr int kEnvelopeOrder = 2;
constexpr double kNotchBandwidth_Hz = 3.0;
/// Share of the rate above which the upper edge of the band-pass would crowd the Nyquist frequency.
constexpr double kHighestEdge = 0.45;
/// An effort of less than that above rest is none.
constexpr double kSmallestEffort_mV = boundOf("emg.mvc_mV").minimum;

double upperEdge(const EmgSettings& settings) {
  return std::min(settings.band_high_Hz, kHighestEdge * settings.rate_Hz);
}

void validate(const EmgSettings& settings) {
  requireRange("emg.rate_Hz", settings.rate_Hz, 1.0 / boundOf("checks.emg_period_s").maximum,
               1.0 / boundOf("checks.emg_period_s").minimum);
  requireRange("emg.channels", settings.channels, 1, kMaxEmgChannels);
  for (int i = 0; i < settings.channels; ++i) {
    const auto& channel = settings.channel[static_cast<std::size_t>(i)];
    const std::string prefix = "emg.channel[" + std::to_string(i + 1) + "].";
    requireBound(boundOf("emg.rest_mV"), channel.rest_mV, prefix + "rest_mV");
    requireRange(prefix + "mvc_mV", channel.mvc_mV, channel.rest_mV + kSmallestEffort_mV,
                 boundOf("emg.mvc_mV").maximum);
    requireBound(boundOf("emg.shape"), channel.shape, prefix + "shape");
  }
  if (settings.bypass) {
    return;
  }
  requireBound(boundOf("emg.band_high_Hz"), settings.band_high_Hz);
  requireRange("emg.band_low_Hz", settings.band_low_Hz, boundOf("emg.band_low_Hz").minimum,
               std::min(boundOf("emg.band_low_Hz").maximum, 0.9 * upperEdge(settings)));
  requireRange("emg.envelope_Hz", settings.envelope_Hz, boundOf("emg.envelope_Hz").minimum,
               std::min(boundOf("emg.envelope_Hz").maximum, kHighestEdge * settings.rate_Hz));
  requireBound(boundOf("emg.twitch_s"), settings.twitch_s);
  if (settings.mains_Hz != 0.0) {
    constexpr double kSlowestMains_Hz = 40.0;
    requireRange("emg.mains_Hz", settings.mains_Hz, kSlowestMains_Hz,
                 std::min(boundOf("emg.mains_Hz").maximum, kHighestEdge * settings.rate_Hz));
  }
}

signal::Biquad twitchResponse(double time_constant_s, double rate_Hz) {
  const double c = time_constant_s > 0.0 ? std::exp(-1.0 / (rate_Hz * time_constant_s)) : 0.0;
  return signal::Biquad({(1.0 - c) * (1.0 - c), 0.0, 0.0, -2.0 * c, c * c});
}

}  // namespace

EmgChain::EmgChain(const EmgSettings& settings) : settings_(settings) {
  validate(settings);
  if (settings.bypass) {
    return;
  }
  Channel prototype;
  prototype.band = signal::bandPass(kBandOrder, settings.band_low_Hz, upperEdge(settings), settings.rate_Hz);
  if (settings.mains_Hz != 0.0) {
    prototype.band.append(signal::notch(settings.mains_Hz, kNotchBandwidth_Hz, settings.rate_Hz));
  }
  prototype.smooth = signal::lowPass(kEnvelopeOrder, settings.envelope_Hz, settings.rate_Hz);
  prototype.twitch = twitchResponse(settings.twitch_s, settings.rate_Hz);
  channels_.fill(prototype);
}

const EmgOutput& EmgChain::update(const EmgArray& sample_mV, int steps) noexcept PATELLA_NONBLOCKING {
  if (steps <= 0) {
    return output_;
  }
  const int bridged = std::min(steps, kMaxBridgedSteps);
  for (std::size_t i = 0; i < static_cast<std::size_t>(settings_.channels); ++i) {
    Channel& channel = channels_[i];
    const EmgChannelSettings& of_channel = settings_.channel[i];
    const double newest =
        std::isfinite(sample_mV[i]) ? std::clamp(sample_mV[i], -kMaxInput_mV, kMaxInput_mV) : channel.last_mV;
    if (settings_.bypass) {
      channel.last_mV = newest;
      output_.envelope_mV[i] = newest;
      output_.activation[i] = newest / of_channel.mvc_mV;
      continue;
    }
    if (!seeded_) {
      channel.band.reset(newest);
      channel.last_mV = newest;
    }
    const double slope = (newest - channel.last_mV) / bridged;
    for (int k = 1; k <= bridged; ++k) {
      const double muscle = channel.band.step(channel.last_mV + k * slope);
      channel.envelope_mV = channel.smooth.step(std::abs(muscle));
      const double normalised =
          (channel.envelope_mV - of_channel.rest_mV) / (of_channel.mvc_mV - of_channel.rest_mV);
      channel.excitation = channel.twitch.step(normalised);
    }
    channel.last_mV = newest;
    // The low-pass undershoots a little after a burst.
    output_.envelope_mV[i] = std::max(channel.envelope_mV, 0.0);
    output_.activation[i] = activation(channel, of_channel);
  }
  seeded_ = true;
  return output_;
}

double EmgChain::activation(const Channel& channel, const EmgChannelSettings& settings) const noexcept {
  constexpr double kLinear = 1e-6;
  const double u = std::clamp(channel.excitation, 0.0, 1.0);
  if (settings.shape > -kLinear) {
    return u;
  }
  return std::expm1(settings.shape * u) / std::expm1(settings.shape);
}

void EmgChain::reset() noexcept PATELLA_NONBLOCKING {
  for (Channel& channel : channels_) {
    channel.band.reset(0.0);
    channel.smooth.reset(0.0);
    channel.twitch.reset(0.0);
    channel.last_mV = 0.0;
    channel.envelope_mV = 0.0;
    channel.excitation = 0.0;
  }
  output_ = {};
  seeded_ = false;
}

}  // namespace patella::emg
