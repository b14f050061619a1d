#include "sim/interaction_force.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "sim/random.hpp"
#include "sim/random_streams.hpp"

namespace patella::sim {
namespace {

constexpr double kLowestTone_Hz = 0.1;

}  // namespace

InteractionForce::InteractionForce(const InteractionOptions& options, std::uint64_t seed)
    : kind_(options.kind),
      begun_s_(options.begun_s),
      tone_amplitude_N_(options.human_rms_N * std::sqrt(2.0 / kTones)) {
  if (!(options.begun_s >= 0.0)) {
    throw std::invalid_argument("begun_s is " + std::to_string(options.begun_s) + ", expected >= 0");
  }
  if (!(options.human_rms_N >= 0.0)) {
    throw std::invalid_argument("human_rms_N is " + std::to_string(options.human_rms_N) + ", expected >= 0");
  }
  if (!(options.human_bandwidth_Hz > kLowestTone_Hz)) {
    throw std::invalid_argument("human_bandwidth_Hz is " + std::to_string(options.human_bandwidth_Hz) +
                                ", expected > 0.1");
  }
  // A sum of tones, one in each equal slice of the band, is defined at every instant: the integrator may ask
  // for trial instants in any order.
  Random random(seed, kInteractionStream);
  const double slice_Hz = (options.human_bandwidth_Hz - kLowestTone_Hz) / kTones;
  for (auto& component : tones_) {
    for (int i = 0; i < kTones; ++i) {
      const double frequency_Hz = kLowestTone_Hz + (i + random.uniform()) * slice_Hz;
      component[static_cast<std::size_t>(i)] = {2.0 * std::numbers::pi * frequency_Hz,
                                                2.0 * std::numbers::pi * random.uniform()};
    }
  }
}

Eigen::Vector2d InteractionForce::at(double time_s) const noexcept {
  const double t = begun_s_ + time_s;
  switch (kind_) {
    case InteractionKind::kNone:
      break;
    case InteractionKind::kExperiment1:
      return {0.1 * t + std::cos(t), 1.0 / (t + 1.0) + std::sin(t)};
    case InteractionKind::kExperiment2:
      return {std::atan(t) + std::cos(t), std::sin(2.0 * t) + std::sin(0.5 * t)};
    case InteractionKind::kHuman: {
      Eigen::Vector2d force = Eigen::Vector2d::Zero();
      for (int axis = 0; axis < 2; ++axis) {
        for (const Tone& tone : tones_[static_cast<std::size_t>(axis)]) {
          force(axis) += tone_amplitude_N_ * std::sin(tone.angular_frequency * t + tone.phase);
        }
      }
      return force;
    }
  }
  return Eigen::Vector2d::Zero();
}

}  // namespace patella::sim
