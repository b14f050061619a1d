#include "core/signal/butterworth.hpp"

#include <complex>
#include <numbers>
#include <sstream>
#include <vector>

#include "core/check.hpp"

namespace patella::signal {
namespace {

using Complex = std::complex<double>;

void checkFrequency(std::string_view key, double frequency_Hz, double rate_Hz) {
  if (!(rate_Hz > 0.0) || !std::isfinite(rate_Hz)) {
    rejectValue("rate_Hz", rate_Hz, "a positive sampling rate");
  }
  if (!(frequency_Hz > 0.0 && frequency_Hz < rate_Hz / 2.0)) {
    std::ostringstream expectation;
    expectation << "between 0 and half the rate (" << rate_Hz / 2.0 << " Hz), both excluded";
    rejectValue(key, frequency_Hz, expectation.str());
  }
}

/// Analogue frequency that the bilinear transform s = (z − 1)/(z + 1) maps onto frequency_Hz.
double prewarp(double frequency_Hz, double rate_Hz) {
  return std::tan(std::numbers::pi * frequency_Hz / rate_Hz);
}

/// Poles of the Butterworth prototype of cutoff 1 with Im >= 0; the others are their conjugates.
std::vector<Complex> prototypePoles(int order) {
  std::vector<Complex> poles;
  for (int k = 0; k < order / 2; ++k) {
    poles.push_back(std::polar(1.0, std::numbers::pi * (0.5 + (2.0 * k + 1.0) / (2.0 * order))));
  }
  if (order % 2 == 1) {
    poles.emplace_back(-1.0, 0.0);
  }
  return poles;
}

Complex bilinear(Complex s) {
  return (1.0 + s) / (1.0 - s);
}

/// Section from its poles' sum and product and a numerator, scaled to |H| = 1 at z.
BiquadCoefficients section(double pole_sum, double pole_product, std::array<double, 3> numerator, Complex z) {
  const Complex delay = 1.0 / z;
  const Complex gain = (numerator[0] + delay * (numerator[1] + delay * numerator[2])) /
                       (1.0 + delay * (-pole_sum + delay * pole_product));
  const double scale = 1.0 / std::abs(gain);
  return {scale * numerator[0], scale * numerator[1], scale * numerator[2], -pole_sum, pole_product};
}

BiquadCoefficients conjugatePair(Complex s, std::array<double, 3> numerator, Complex z) {
  const Complex pole = bilinear(s);
  return section(2.0 * pole.real(), std::norm(pole), numerator, z);
}

/// Low-pass with zeros at z = −1, or high-pass with zeros at z = +1; `side` is +1 or −1, the point of gain 1.
BiquadCascade onePassband(int order, double cutoff_Hz, double rate_Hz, double side) {
  requireRange("filter order", order, 1, 2 * BiquadCascade::kMaxSections);
  checkFrequency("cutoff_Hz", cutoff_Hz, rate_Hz);
  const double cutoff = prewarp(cutoff_Hz, rate_Hz);
  BiquadCascade cascade;
  for (const Complex& p : prototypePoles(order)) {
    const Complex s = side > 0.0 ? cutoff * p : cutoff / p;
    if (p.imag() > 0.0) {
      cascade.append(conjugatePair(s, {1.0, 2.0 * side, 1.0}, side));
    } else {
      cascade.append(section(bilinear(s).real(), 0.0, {1.0, side, 0.0}, side));
    }
  }
  return cascade;
}

}  // namespace

BiquadCascade lowPass(int order, double cutoff_Hz, double rate_Hz) {
  return onePassband(order, cutoff_Hz, rate_Hz, 1.0);
}

BiquadCascade highPass(int order, double cutoff_Hz, double rate_Hz) {
  return onePassband(order, cutoff_Hz, rate_Hz, -1.0);
}

BiquadCascade bandPass(int order, double low_Hz, double high_Hz, double rate_Hz) {
  requireRange("filter order", order, 1, BiquadCascade::kMaxSections);
  checkFrequency("low_Hz", low_Hz, rate_Hz);
  checkFrequency("high_Hz", high_Hz, rate_Hz);
  if (!(low_Hz < high_Hz)) {
    rejectValue("low_Hz", low_Hz, "below high_Hz");
  }
  const double low = prewarp(low_Hz, rate_Hz);
  const double high = prewarp(high_Hz, rate_Hz);
  const double centre_squared = low * high;
  const Complex centre = bilinear(Complex(0.0, std::sqrt(centre_squared)));

  // The low-pass variable p becomes (s² + centre²)/(s (high − low)): every prototype pole yields two roots.
  BiquadCascade cascade;
  for (const Complex& p : prototypePoles(order)) {
    const Complex half = 0.5 * p * (high - low);
    const Complex root = std::sqrt(half * half - centre_squared);
    if (p.imag() > 0.0) {
      cascade.append(conjugatePair(half + root, {1.0, 0.0, -1.0}, centre));
      cascade.append(conjugatePair(half - root, {1.0, 0.0, -1.0}, centre));
    } else {
      const Complex first = bilinear(half + root);
      const Complex second = bilinear(half - root);
      cascade.append(section((first + second).real(), (first * second).real(), {1.0, 0.0, -1.0}, centre));
    }
  }
  return cascade;
}

BiquadCascade notch(double frequency_Hz, double bandwidth_Hz, double rate_Hz) {
  checkFrequency("frequency_Hz", frequency_Hz, rate_Hz);
  checkFrequency("bandwidth_Hz", bandwidth_Hz, rate_Hz);
  const double gain = 1.0 / (1.0 + prewarp(bandwidth_Hz, rate_Hz));
  const double cosine = std::cos(2.0 * std::numbers::pi * frequency_Hz / rate_Hz);
  BiquadCascade cascade;
  cascade.append({gain, -2.0 * gain * cosine, gain, -2.0 * gain * cosine, 2.0 * gain - 1.0});
  return cascade;
}

}  // namespace patella::signal
