#include "tools/diagnose/regression/sensor_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/diagnose/regression/cosine_transform.hpp"

namespace patella::diagnose {
namespace {

/// An octave has to tell its level.
constexpr double kFewestInOctave = 20.0;

using Signals = std::array<std::vector<double>, kMaxJoints>;

/// Mean square of the coefficients in the quietest octave above `low_Hz`; 0 where there is none.
double quietest(std::span<const double> signal, double rate_Hz, double low_Hz) {
  const auto length = static_cast<Eigen::Index>(signal.size());
  const double step_Hz = 0.5 * rate_Hz / static_cast<double>(length);
  CosineTransform transform(length);
  const Eigen::VectorXd& spectrum = transform.of(Eigen::Map<const Eigen::VectorXd>(signal.data(), length));
  double least = 0.0;
  for (double edge_Hz = low_Hz; 2.0 * edge_Hz <= 0.5 * rate_Hz; edge_Hz *= 2.0) {
    const auto first = static_cast<Eigen::Index>(edge_Hz / step_Hz);
    const Eigen::Index count = std::min(first, length - first);
    if (static_cast<double>(count) >= kFewestInOctave) {
      const double level = spectrum.segment(first, count).squaredNorm() / static_cast<double>(count);
      least = least == 0.0 ? level : std::min(least, level);
    }
  }
  return least;
}

/// Density of a signal's white noise, its square per Hz, mean over all rows.
double density(std::span<const Recording> recordings, Signals Recording::*signals, std::size_t joint,
               double low_Hz) {
  double sum = 0.0, rows = 0.0;
  for (const Recording& recording : recordings) {
    for (const Segment& stretch : recording.segments) {
      const std::size_t count = stretch.end - stretch.first;
      const std::span<const double> values = std::span(recording.*signals)[joint];
      sum += static_cast<double>(count) * 2.0 / recording.rate_Hz *
             quietest(values.subspan(stretch.first, count), recording.rate_Hz, low_Hz);
      rows += static_cast<double>(count);
    }
  }
  return sum / rows;
}

JointVector meanPosition(std::span<const Recording> recordings, int joints) {
  JointVector mean = JointVector::Zero(joints);
  double rows = 0.0;
  for (const Recording& recording : recordings) {
    for (std::size_t i = 0; i < recording.rows(); ++i) {
      for (int j = 0; j < joints; ++j) {
        mean[j] += recording.position_rad[static_cast<std::size_t>(j)][i];
      }
    }
    rows += static_cast<double>(recording.rows());
  }
  return mean / rows;
}

}  // namespace

std::vector<double> sensorNoise_Nm(std::span<const Recording> recordings, const model::Mechanism& mechanism,
                                   double band_Hz) {
  const int joints = mechanism.joints();
  if (recordings.front().is_static) {
    return std::vector<double>(static_cast<std::size_t>(joints), 0.0);
  }
  // ∫ (2π f)⁴ df from 0 to the band's edge
  const double twice_differentiated = std::pow(2.0 * std::numbers::pi, 4) * std::pow(band_Hz, 5) / 5.0;
  const JointMatrix inertia = mechanism.inertia(meanPosition(recordings, joints));
  std::vector<double> noise_Nm;
  for (int joint = 0; joint < joints; ++joint) {
    double square =
        band_Hz * density(recordings, &Recording::torque_Nm, static_cast<std::size_t>(joint), 2.0 * band_Hz);
    for (int k = 0; k < joints; ++k) {
      square += inertia(joint, k) * inertia(joint, k) * twice_differentiated *
                density(recordings, &Recording::position_rad, static_cast<std::size_t>(k), 2.0 * band_Hz);
    }
    noise_Nm.push_back(std::sqrt(square));
  }
  return noise_Nm;
}

}  // namespace patella::diagnose
