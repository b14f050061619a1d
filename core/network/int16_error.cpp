#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/network/attention_lstm.hpp"

namespace patella::network {

namespace {

/// Numerical Recipes' linear congruence: the same numbers on every machine.
class Noise {
 public:
  /// Uniform in [-1, 1).
  double next() noexcept {
    state_ = state_ * 1664525U + 1013904223U;
    return static_cast<double>(state_) * 0x1p-31 - 1.0;
  }

 private:
  std::uint32_t state_ = 1;
};

/// Unlike periods from 15 to 600 steps, so that features and their combinations sweep the range.
double probe(int step, std::size_t feature, double noise) noexcept {
  const double slow = 600.0 / std::sqrt(1.0 + static_cast<double>(feature));
  const double fast = 15.0 + 7.0 * static_cast<double>(feature % 8);
  const double turn = 2.0 * std::numbers::pi * step;
  return 1.2 * std::sin(turn / slow) + 0.5 * std::sin(turn / fast) + 0.3 * noise;
}

}  // namespace

double AttentionLstm::int16Error(const NetworkWeights& weights) {
  const kernel::Functions& functions = kernel::functionsFor({});
  checkWeights(weights);
  AttentionLstm exact(weights, Precision::kFloat32, functions);
  AttentionLstm rounded(weights, Precision::kInt16, functions);
  Noise noise;
  std::vector<double> features(weights.features.size());
  const int half = 500 + weights.window / 2;
  double error = 0.0;
  for (int step = 0; step < 2 * half; ++step) {
    const double width = step < half ? 1.0 : 3.0;
    for (std::size_t i = 0; i < features.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      features[i] =
          width * probe(step, i, noise.next()) * weights.feature_scale[index] + weights.feature_mean[index];
    }
    const Eigen::ArrayXd difference =
        (rounded.step(features) - exact.step(features)).array() / weights.output_scale.array();
    if (!difference.allFinite())
      return std::numeric_limits<double>::quiet_NaN();
    error = std::max(error, difference.abs().maxCoeff());
  }
  return error;
}

}  // namespace patella::network
