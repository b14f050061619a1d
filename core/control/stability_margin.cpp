#include "core/control/stability_margin.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace patella::control {
namespace {

using Complex = std::complex<double>;

constexpr double kLowest_Hz = 0.01;
constexpr double kStep = 1.01;  ///< from one frequency to the next
/// From a sample to the middle of the command's hold: a tick at most, and half of one.
constexpr double kLatency_periods = 1.5;

/// Second-order Butterworth; 1 without a cutoff.
Complex lowPass(Complex s, double cutoff_Hz) noexcept {
  if (cutoff_Hz == 0.0) {
    return 1.0;
  }
  const Complex x = s / (2.0 * std::numbers::pi * cutoff_Hz);
  return 1.0 / (x * x + std::numbers::sqrt2 * x + 1.0);
}

Complex openLoop(const JointLoop& loop, double model_inertia, double inertia, double omega_rad_s) noexcept {
  const Complex s(0.0, omega_rad_s);
  const double h_s = loop.lateness_s;
  const Complex arrives = std::exp(-s * (h_s + kLatency_periods * loop.period_s));
  const Complex position = arrives / (inertia * s * s);
  const Complex velocity = s * position * lowPass(s, loop.velocity_cutoff_Hz);
  const Complex late = std::exp(-s * h_s);
  const Complex under_way_first = (1.0 - late) / s;
  const Complex under_way_second = (1.0 - (1.0 + s * h_s) * late) / (s * s);
  const bool estimated = loop.compensation > 0.0;
  const double by_estimate = estimated ? loop.compensation * model_inertia + loop.damping_Nms_rad * h_s +
                                             0.5 * loop.stiffness_Nm_rad * h_s * h_s
                                       : 0.0;
  return loop.stiffness_Nm_rad * (position + h_s * velocity + under_way_second / model_inertia) +
         loop.damping_Nms_rad * (velocity + under_way_first / model_inertia) +
         by_estimate * lowPass(s, loop.estimate_cutoff_Hz) * (1.0 / inertia - 1.0 / model_inertia) * arrives;
}

}  // namespace

// By Nyquist's criterion: L has no pole to the right of the imaginary axis, and n on it, at 0. So the loop is
// stable where 1 + L turns by n quarters of a circle, counter-clockwise, on the way up from there.
PhaseMargin phaseMargin(const JointLoop& loop, double model_inertia_kg_m2, double inertia_kg_m2) noexcept {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  const auto at = [&](double frequency_Hz) {
    return openLoop(loop, model_inertia_kg_m2, inertia_kg_m2, kTwoPi * frequency_Hz);
  };
  PhaseMargin least{std::numeric_limits<double>::infinity(), 0.0, inertia_kg_m2};
  double turned_rad = 0.0;
  double frequency_Hz = kLowest_Hz;
  Complex before = at(frequency_Hz);
  while (frequency_Hz * kStep <= 0.5 / loop.period_s) {
    frequency_Hz *= kStep;
    const Complex now = at(frequency_Hz);
    turned_rad += std::arg((1.0 + now) / (1.0 + before));
    if ((std::abs(before) >= 1.0) != (std::abs(now) >= 1.0)) {
      const double margin_deg = std::abs(std::arg(-now)) * 180.0 / std::numbers::pi;
      if (margin_deg < least.margin_deg) {
        least = {margin_deg, frequency_Hz, inertia_kg_m2};
      }
    }
    before = now;
  }
  const double quarters = loop.stiffness_Nm_rad > 0.0 ? 2.0 : loop.damping_Nms_rad > 0.0 ? 1.0 : 0.0;
  if (std::abs(turned_rad - quarters * kTwoPi / 4.0) > kTwoPi / 4.0) {
    least.margin_deg = std::isfinite(least.margin_deg) ? -least.margin_deg : -180.0;
  }
  return least;
}

PhaseMargin leastPhaseMargin(const JointLoop& loop, double model_inertia_kg_m2) noexcept {
  PhaseMargin least = phaseMargin(loop, model_inertia_kg_m2, model_inertia_kg_m2);
  for (const double share : {1.0 - kInertiaTolerance, 1.0 + kInertiaTolerance}) {
    const PhaseMargin other = phaseMargin(loop, model_inertia_kg_m2, share * model_inertia_kg_m2);
    if (other.margin_deg < least.margin_deg) {
      least = other;
    }
  }
  return least;
}

}  // namespace patella::control
