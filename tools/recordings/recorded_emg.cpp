#include "tools/recordings/recorded_emg.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/emg/emg_chain.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::diagnose {
namespace {

constexpr double kLowestRate_Hz = 200.0;
/// Below it a channel holds nothing.
constexpr double kSilence = 1e-9;

}  // namespace

bool silent(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::abs(value) < kSilence; });
}

EmgChannels activationOf(const EmgChannels& emg_mV, const Recording& recording) {
  if (recording.rate_Hz < kLowestRate_Hz) {
    throw app::FileError(
        fmt::format("{}: raw EMG at {:.4g} Hz, expected at least {:.4g} Hz, or its envelope as activation",
                    recording.name, recording.rate_Hz, kLowestRate_Hz));
  }
  emg::EmgChain chain({.rate_Hz = recording.rate_Hz});
  EmgChannels activation;
  for (const Segment& segment : recording.segments) {
    chain.reset();
    for (std::size_t i = segment.first; i < segment.end; ++i) {
      EmgArray sample{};
      for (std::size_t c = 0; c < sample.size(); ++c) {
        sample[c] = emg_mV[c].empty() ? 0.0 : emg_mV[c][i];
      }
      const EmgArray envelope_mV = chain.update(sample, 1).envelope_mV;
      for (std::size_t c = 0; c < sample.size(); ++c) {
        activation[c].push_back(envelope_mV[c]);
      }
    }
  }
  for (std::vector<double>& channel : activation) {
    const double largest = *std::max_element(channel.begin(), channel.end());
    if (largest < kSilence) {
      channel.clear();
    }
    for (double& value : channel) {
      value = std::max(0.0, value / largest);
    }
  }
  return activation;
}

}  // namespace patella::diagnose
