#include "tools/signals/spectral_lines.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <unsupported/Eigen/FFT>

namespace patella::offline {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
/// Points of the spectrum per width of a line.
constexpr std::size_t kFineness = 4;
/// Half the width of the surroundings, in widths of a line.
constexpr std::size_t kSurroundings = 20;
/// Lines nearer than this share of a width are one.
constexpr double kSameLine = 0.5;

// Periodogram with a Hann window, at kFineness points per 1/duration.
class Periodogram {
 public:
  explicit Periodogram(std::size_t samples) {
    std::size_t length = 1;
    while (length < kFineness * samples) {
      length *= 2;
    }
    padded_.resize(length);
    for (std::size_t i = 0; i < samples; ++i) {
      window_.push_back(
          0.5 - 0.5 * std::cos(kTurn * (static_cast<double>(i) + 0.5) / static_cast<double>(samples)));
    }
  }

  std::size_t length() const noexcept { return padded_.size(); }

  const std::vector<double>& of(const Eigen::VectorXd& signal) {
    std::fill(padded_.begin(), padded_.end(), 0.0);
    for (std::size_t i = 0; i < window_.size(); ++i) {
      padded_[i] = window_[i] * signal[static_cast<Eigen::Index>(i)];
    }
    fft_.fwd(transformed_, padded_);
    power_.resize(padded_.size() / 2);
    for (std::size_t k = 0; k < power_.size(); ++k) {
      power_[k] = std::norm(transformed_[k]);
    }
    return power_;
  }

 private:
  std::vector<double> window_;
  std::vector<double> padded_;
  std::vector<std::complex<double>> transformed_;
  std::vector<double> power_;
  Eigen::FFT<double> fft_;
};

double medianAround(const std::vector<double>& power, std::size_t peak, std::size_t reach) {
  const std::size_t first = peak > reach ? peak - reach : 1;
  const std::size_t end = std::min(power.size(), peak + reach + 1);
  return median(std::span(power).subspan(first, end - first));
}

// Where the peak about point k has its top: a window's main lobe is a parabola in the logarithm.
double summit(const std::vector<double>& power, std::size_t k) {
  const double left = std::log(power[k - 1] / power[k]);
  const double right = std::log(power[k + 1] / power[k]);
  const double bend = left + right;
  return static_cast<double>(k) + (bend < 0.0 ? 0.5 * (left - right) / bend : 0.0);
}

// Frequencies of new lines, `most` of them: peaks that stand out from their surroundings and that no side
// lobe of a higher one reaches.
std::vector<double> highestPeaks(const std::vector<double>& power, double bin_Hz, double width_Hz,
                                 std::span<const double> known_Hz, std::size_t most,
                                 const SpectralLineOptions& options) {
  constexpr double kAboveSideLobes = 0.03;
  const auto first = static_cast<std::size_t>(std::ceil(width_Hz / bin_Hz));
  const auto last = std::min(power.size() - 2, static_cast<std::size_t>(options.highest_Hz / bin_Hz));
  if (first >= last) {
    return {};
  }
  std::vector<std::pair<double, double>> peaks;  // power and frequency
  const double highest = *std::max_element(power.begin() + static_cast<std::ptrdiff_t>(first),
                                           power.begin() + static_cast<std::ptrdiff_t>(last));
  for (std::size_t k = first; k < last; ++k) {
    if (power[k] < kAboveSideLobes * highest || power[k] < power[k - 1] || power[k] < power[k + 1] ||
        power[k] < options.least_prominence * medianAround(power, k, kSurroundings * kFineness)) {
      continue;
    }
    const double frequency_Hz = bin_Hz * summit(power, k);
    const bool known = std::any_of(known_Hz.begin(), known_Hz.end(), [&](double f) {
      return std::abs(f - frequency_Hz) < kSameLine * width_Hz;
    });
    if (!known) {
      peaks.emplace_back(power[k], frequency_Hz);
    }
  }
  if (peaks.size() > most) {
    std::partial_sort(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(most), peaks.end(),
                      std::greater<>());
    peaks.resize(most);
  }
  std::vector<double> found;
  for (const auto& [height, frequency_Hz] : peaks) {
    found.push_back(frequency_Hz);
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Constant, then cosine and sine of each frequency.
Eigen::MatrixXd columns(std::span<const double> frequencies_Hz, Eigen::Index samples, double rate_Hz) {
  Eigen::MatrixXd all(samples, 1 + 2 * static_cast<Eigen::Index>(frequencies_Hz.size()));
  all.col(0).setOnes();
  const Eigen::ArrayXd time_s =
      Eigen::ArrayXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) / rate_Hz);
  for (std::size_t k = 0; k < frequencies_Hz.size(); ++k) {
    const Eigen::ArrayXd angle = kTurn * frequencies_Hz[k] * time_s;
    all.col(1 + 2 * static_cast<Eigen::Index>(k)) = angle.cos();
    all.col(2 + 2 * static_cast<Eigen::Index>(k)) = angle.sin();
  }
  return all;
}

Eigen::VectorXd amplitudes(const Eigen::MatrixXd& columns, const Eigen::VectorXd& signal) {
  Eigen::MatrixXd gram = columns.transpose() * columns;
  gram.diagonal().array() += 1e-9 * static_cast<double>(signal.size());
  return gram.ldlt().solve(columns.transpose() * signal);
}

// Every nth sample of what a low-pass leaves: the search needs no more.
Eigen::VectorXd coarse(std::span<const double> signal, double rate_Hz, double highest_Hz, std::size_t step) {
  const Samples slow = zeroPhaseLowPass(signal, std::min(1.5 * highest_Hz, 0.4 * rate_Hz), rate_Hz, 4);
  Eigen::VectorXd kept(static_cast<Eigen::Index>((slow.size() + step - 1) / step));
  for (Eigen::Index i = 0; i < kept.size(); ++i) {
    kept[i] = slow[static_cast<std::size_t>(i) * step];
  }
  return kept;
}

}  // namespace

Samples lineSpectrumPart(std::span<const double> signal, double rate_Hz, const SpectralLineOptions& options) {
  constexpr double kSamplesPerPeriod = 4.0;
  const auto step =
      static_cast<std::size_t>(std::max(1.0, std::floor(rate_Hz / (kSamplesPerPeriod * options.highest_Hz))));
  const double coarse_Hz = rate_Hz / static_cast<double>(step);
  const Eigen::VectorXd target = coarse(signal, rate_Hz, options.highest_Hz, step);
  const double width_Hz = coarse_Hz / static_cast<double>(target.size());
  Periodogram periodogram(static_cast<std::size_t>(target.size()));
  const double bin_Hz = coarse_Hz / static_cast<double>(periodogram.length());

  std::vector<double> frequencies_Hz;
  Eigen::VectorXd rest = target.array() - target.mean();
  while (static_cast<int>(frequencies_Hz.size()) < options.most) {
    const std::vector<double> found =
        highestPeaks(periodogram.of(rest), bin_Hz, width_Hz, frequencies_Hz,
                     static_cast<std::size_t>(options.most) - frequencies_Hz.size(), options);
    if (found.empty()) {
      break;
    }
    frequencies_Hz.insert(frequencies_Hz.end(), found.begin(), found.end());
    const Eigen::MatrixXd lines = columns(frequencies_Hz, target.size(), coarse_Hz);
    rest = target - lines * amplitudes(lines, target);
  }

  const Eigen::VectorXd amplitude = amplitudes(columns(frequencies_Hz, target.size(), coarse_Hz), target);
  const Eigen::VectorXd part =
      columns(frequencies_Hz, static_cast<Eigen::Index>(signal.size()), rate_Hz) * amplitude;
  return {part.begin(), part.end()};
}

}  // namespace patella::offline
