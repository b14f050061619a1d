#include "tools/diagnose/regression/smoothed_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tools/signals/signals.hpp"
#include "tools/signals/spectral_lines.hpp"

namespace patella::diagnose {
namespace {

using offline::Samples;

Samples part(const std::vector<double>& signal, const Segment& segment) {
  return {signal.begin() + static_cast<std::ptrdiff_t>(segment.first),
          signal.begin() + static_cast<std::ptrdiff_t>(segment.end)};
}

Samples everyNth(const Samples& signal, std::size_t step) {
  Samples kept;
  kept.reserve(signal.size() / step + 1);
  for (std::size_t i = 0; i < signal.size(); i += step) {
    kept.push_back(signal[i]);
  }
  return kept;
}

// Torque at the instant of a sample: of one that was held, the mean of the step before and the step after.
Samples actingTorque(Samples torque, TorqueTiming timing) {
  if (timing == TorqueTiming::kHeld) {
    for (std::size_t i = torque.size() - 1; i > 0; --i) {
      torque[i] = 0.5 * (torque[i] + torque[i - 1]);
    }
  } else if (timing == TorqueTiming::kBefore) {
    for (std::size_t i = 0; i + 1 < torque.size(); ++i) {
      torque[i] = 0.5 * (torque[i] + torque[i + 1]);
    }
  }
  return torque;
}

/// Of one joint, at the instants of a series.
struct JointSamples {
  Samples q, dq, ddq, asked_ddq;  ///< rad and its rates
  Samples torque_Nm, asked_torque_Nm;
};

/// Every `step`-th sample of what is left of a stretch of the recording below options.smoothing_Hz.
JointSamples smoothedJoint(const Recording& recording, const Segment& segment, const DatasetOptions& options,
                           std::size_t joint, std::size_t step) {
  const double rate_Hz = recording.rate_Hz;
  const double kept_rate_Hz = rate_Hz / static_cast<double>(step);
  const auto smooth = [&](const Samples& raw, double cutoff_Hz) {
    return offline::zeroPhaseLowPass(raw, cutoff_Hz, rate_Hz, kFilterOrder);
  };
  const double smoothing_Hz = std::min(options.smoothing_Hz, 0.2 * rate_Hz);
  // Differentiated at the full rate, where central differences reach furthest.
  const Samples position = smooth(part(recording.position_rad[joint], segment), smoothing_Hz);
  const Samples velocity = offline::derivative(position, rate_Hz);
  const Samples acceleration = offline::derivative(velocity, rate_Hz);
  const Samples torque = actingTorque(part(recording.torque_Nm[joint], segment), recording.torque_timing);
  JointSamples kept{
      .q = everyNth(position, step),
      .dq = everyNth(velocity, step),
      .ddq = everyNth(acceleration, step),
      .asked_ddq = everyNth(smooth(acceleration, std::min(0.5 * options.band_Hz, 0.1 * rate_Hz)), step),
      .torque_Nm = everyNth(smooth(torque, smoothing_Hz), step),
      .asked_torque_Nm = {}};
  if (options.asked_part) {
    kept.asked_ddq =
        offline::lineSpectrumPart(kept.asked_ddq, kept_rate_Hz, {.highest_Hz = 0.5 * options.band_Hz});
    kept.asked_torque_Nm =
        offline::lineSpectrumPart(kept.torque_Nm, kept_rate_Hz, {.highest_Hz = options.band_Hz});
  } else {
    kept.asked_torque_Nm.assign(kept.torque_Nm.size(), 0.0);
  }
  return kept;
}

}  // namespace

Series restingSeries(const Recording& recording, const Segment& segment) {
  Series series;
  series.rate_Hz = 1.0;
  for (std::size_t i = segment.first; i < segment.end; ++i) {
    model::EffectInput state;
    state.time_s = recording.time_s[i];
    state.q.setZero(recording.joints);
    state.dq.setZero(recording.joints);
    state.torque_Nm.setZero(recording.joints);
    for (int joint = 0; joint < recording.joints; ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      state.q[joint] = recording.position_rad[j][i];
      state.torque_Nm[joint] = recording.torque_Nm[j][i];
    }
    series.states.push_back(state);
    series.acceleration.emplace_back(JointVector::Zero(recording.joints));
    series.asked_acceleration.emplace_back(JointVector::Zero(recording.joints));
    series.measured_torque_Nm.push_back(state.torque_Nm);
    series.asked_torque_Nm.emplace_back(JointVector::Zero(recording.joints));
  }
  return series;
}

Series movingSeries(const Recording& recording, const Segment& segment, const DatasetOptions& options) {
  const auto step =
      static_cast<std::size_t>(std::max(1.0, std::floor(recording.rate_Hz / options.evaluation_rate_Hz)));
  std::vector<JointSamples> joints;
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    joints.push_back(smoothedJoint(recording, segment, options, j, step));
  }
  std::array<Samples, kMaxEmgChannels> activation;
  for (std::size_t channel = 0; channel < activation.size(); ++channel) {
    if (!recording.activation[channel].empty()) {
      activation[channel] = everyNth(part(recording.activation[channel], segment), step);
    }
  }
  const auto at = [&](Samples JointSamples::*samples, std::size_t i) {
    JointVector values(recording.joints);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      values[static_cast<Eigen::Index>(j)] = (joints[j].*samples)[i];
    }
    return values;
  };
  Series series;
  series.rate_Hz = recording.rate_Hz / static_cast<double>(step);
  series.lead = (segment.lead + step - 1) / step;
  for (std::size_t i = 0; i < joints.front().q.size(); ++i) {
    model::EffectInput state;
    state.q = at(&JointSamples::q, i);
    state.dq = at(&JointSamples::dq, i);
    state.torque_Nm = at(&JointSamples::torque_Nm, i);
    for (std::size_t channel = 0; channel < activation.size(); ++channel) {
      state.activation[channel] = activation[channel].empty() ? 0.0 : activation[channel][i];
    }
    state.time_s = recording.time_s[segment.first + i * step];
    series.states.push_back(state);
    series.acceleration.push_back(at(&JointSamples::ddq, i));
    series.asked_acceleration.push_back(at(&JointSamples::asked_ddq, i));
    series.measured_torque_Nm.push_back(state.torque_Nm);
    series.asked_torque_Nm.push_back(at(&JointSamples::asked_torque_Nm, i));
  }
  return series;
}

}  // namespace patella::diagnose
