#include "tools/diagnose/verdict/tremor_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>

#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

constexpr double kStretch_s = 4.0;
constexpr double kStep_Hz = 0.25;
/// Neighbours that tell what the power would be without a line: beyond the line's own width, within this.
constexpr double kLineWidth_Hz = 0.6;
constexpr double kNeighbourhood_Hz = 2.0;
/// Independent values per stretch of stretches that overlap by half, under a Hann window (Welch 1967).
constexpr double kIndependence = 0.9;

struct Periodogram {
  std::vector<double> frequency_Hz;
  std::vector<double> power;  ///< mean square in the resolution's width
  double stretches = 0.0;
};

Periodogram periodogram(const Dataset& data, const Eigen::VectorXd& residual, int joint) {
  Periodogram result;
  for (double f = tremor::kLowest_Hz - kNeighbourhood_Hz;
       f <= std::min(tremor::kHighest_Hz + kNeighbourhood_Hz, 0.45 * data.rate_Hz()); f += kStep_Hz) {
    result.frequency_Hz.push_back(f);
  }
  result.power.assign(result.frequency_Hz.size(), 0.0);
  const auto length = static_cast<Eigen::Index>(kStretch_s * data.rate_Hz());
  Eigen::VectorXd window(length);
  for (Eigen::Index i = 0; i < length; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                                     static_cast<double>(length));
  }
  const double sum = window.sum();
  for (const Block& block : data.blocks()) {
    for (Eigen::Index first = block.first; first + length <= block.end; first += length / 2) {
      const Eigen::VectorXd part = residual.segment(joint * data.rows() + first, length).cwiseProduct(window);
      for (std::size_t k = 0; k < result.power.size(); ++k) {
        const std::complex<double> turn =
            std::polar(1.0, 2.0 * std::numbers::pi * result.frequency_Hz[k] / data.rate_Hz());
        std::complex<double> phase = 1.0, total = 0.0;
        for (Eigen::Index i = 0; i < length; ++i) {
          total += part[i] * phase;
          phase *= turn;
        }
        const double gain = data.gain(result.frequency_Hz[k]);
        result.power[k] += 2.0 * std::norm(total) / (sum * sum * gain * gain);
      }
      result.stretches += 1.0;
    }
  }
  for (double& power : result.power) {
    power /= std::max(1.0, result.stretches);
  }
  return result;
}

double neighbourhood(const Periodogram& spectrum, std::size_t line) {
  std::vector<double> around;
  for (std::size_t k = 0; k < spectrum.power.size(); ++k) {
    const double distance = std::abs(spectrum.frequency_Hz[k] - spectrum.frequency_Hz[line]);
    if (distance > kLineWidth_Hz && distance <= kNeighbourhood_Hz) {
      around.push_back(spectrum.power[k]);
    }
  }
  std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2),
                   around.end());
  return around[around.size() / 2];
}

// Whether neither side of a line stands higher above its neighbourhood than the line's own foot and chance,
// of three standard deviations, put there.
bool isNarrow(const Periodogram& spectrum, std::size_t line, double background) {
  std::array<double, 2> sum{}, count{};
  for (std::size_t k = 0; k < spectrum.power.size(); ++k) {
    const double distance = spectrum.frequency_Hz[k] - spectrum.frequency_Hz[line];
    if (std::abs(distance) > kLineWidth_Hz && std::abs(distance) <= tremor::kShoulder_Hz) {
      const std::size_t side = distance < 0.0 ? 0 : 1;
      sum[side] += spectrum.power[k];
      count[side] += 1.0;
    }
  }
  const double allowed =
      background * (1.0 + tremor::kChance / std::sqrt(2.0 * kIndependence * spectrum.stretches)) +
      tremor::kShoulder * (spectrum.power[line] - background);
  return sum[0] <= allowed * count[0] && sum[1] <= allowed * count[1];
}

}  // namespace

std::optional<TremorLine> findTremorLine(const Dataset& data, const Eigen::VectorXd& residual, int joint,
                                         double family_wise_p) {
  if (data.isStatic()) {
    return std::nullopt;
  }
  const Periodogram spectrum = periodogram(data, residual, joint);
  if (spectrum.stretches < tremor::kFewestStretches) {
    return std::nullopt;
  }
  std::optional<TremorLine> best;
  const double freedom = 2.0 * kIndependence * spectrum.stretches;
  const double trials = data.joints() * (tremor::kHighest_Hz - tremor::kLowest_Hz) / kStep_Hz;
  for (std::size_t k = 0; k < spectrum.power.size(); ++k) {
    const double f = spectrum.frequency_Hz[k];
    if (f < tremor::kLowest_Hz || f > tremor::kHighest_Hz) {
      continue;
    }
    const double background = neighbourhood(spectrum, k);
    if (!(background > 0.0)) {
      continue;
    }
    const double ratio = spectrum.power[k] / background;
    const double tail = boost::math::cdf(
        boost::math::complement(boost::math::chi_squared(freedom), std::min(freedom * ratio, 1e4)));
    const double p_value = std::min(1.0, trials * tail);
    if (p_value < family_wise_p && isNarrow(spectrum, k, background) &&
        (!best || spectrum.power[k] - background > 0.5 * best->amplitude_Nm * best->amplitude_Nm)) {
      // A Hann window spreads a line over one and a half resolutions; a wandering one is wider still.
      double power = 0.0, moment = 0.0;
      for (std::size_t i = 0; i < spectrum.power.size(); ++i) {
        if (std::abs(spectrum.frequency_Hz[i] - f) <= kLineWidth_Hz) {
          const double excess = std::max(0.0, spectrum.power[i] - background);
          power += excess / 1.5;
          moment += excess / 1.5 * spectrum.frequency_Hz[i];
        }
      }
      best = TremorLine{.joint = joint,
                        .frequency_Hz = moment / power,
                        .frequency_sd_Hz = 0.5 / (kStretch_s * std::sqrt(spectrum.stretches)) * 2.0,
                        .amplitude_Nm = std::sqrt(2.0 * power),
                        .amplitude_sd_Nm = std::sqrt(2.0 * power) / std::sqrt(2.0 * freedom),
                        .p_value = std::max(p_value, 1e-12)};
    }
  }
  return best;
}

}  // namespace patella::diagnose
