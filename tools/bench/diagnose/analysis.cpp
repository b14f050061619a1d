#include "tools/bench/diagnose/analysis.hpp"

#include <cmath>

#include <Eigen/QR>

#include "tools/bench/diagnose/nominal_directions.hpp"
#include "tools/signals/signals.hpp"

namespace patella::bench {
namespace {

using offline::Samples;

constexpr double kRecordedRate_Hz = 1.0 / kTick_s;
constexpr double kSmoothing_Hz = 40.0;
constexpr std::size_t kDecimation = 4;
constexpr double kRate_Hz = kRecordedRate_Hz / kDecimation;
constexpr std::size_t kRowStep = 5;
constexpr double kEdge_s = 0.5;
constexpr int kOrder = 4;

Samples everyFourth(const Samples& signal) {
  Samples kept;
  for (std::size_t i = 0; i < signal.size(); i += kDecimation) {
    kept.push_back(signal[i]);
  }
  return kept;
}

struct Motion {
  std::array<Samples, kJoints> q, dq, ddq;
  std::size_t size() const { return q[0].size(); }
};

Motion motionOf(std::span<const std::vector<double>> position, std::size_t joints) {
  Motion motion;
  for (std::size_t j = 0; j < joints; ++j) {
    const Samples q = offline::zeroPhaseLowPass(position[j], kSmoothing_Hz, kRecordedRate_Hz, kOrder);
    const Samples dq = offline::derivative(q, kRecordedRate_Hz);
    motion.q[j] = everyFourth(q);
    motion.dq[j] = everyFourth(dq);
    motion.ddq[j] = everyFourth(offline::derivative(dq, kRecordedRate_Hz));
  }
  return motion;
}

class Band {
 public:
  explicit Band(double band_Hz) : band_Hz_(band_Hz) {}

  Samples operator()(const Samples& signal) const {
    const Samples filtered = offline::zeroPhaseLowPass(signal, band_Hz_, kRate_Hz, kOrder);
    const auto edge = static_cast<std::ptrdiff_t>(kEdge_s * kRate_Hz);
    return {filtered.begin() + edge, filtered.end() - edge};
  }
  Samples ofRecorded(const std::vector<double>& signal) const {
    return (*this)(everyFourth(offline::zeroPhaseLowPass(signal, kSmoothing_Hz, kRecordedRate_Hz, kOrder)));
  }

 private:
  double band_Hz_;
};

std::array<Samples, kJoints> bodyTorque(const Body& body, const Motion& motion, const Band& band) {
  std::array<Samples, kJoints> torque;
  InverseDynamics dynamics(body);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    PerJoint q{}, dq{}, ddq{};
    for (std::size_t j = 0; j < body.joints(); ++j) {
      q[j] = motion.q[j][i];
      dq[j] = motion.dq[j][i];
      ddq[j] = motion.ddq[j][i];
    }
    const PerJoint value = dynamics(q, dq, ddq);
    for (std::size_t j = 0; j < body.joints(); ++j) {
      torque[j].push_back(value[j]);
    }
  }
  for (std::size_t j = 0; j < body.joints(); ++j) {
    torque[j] = band(torque[j]);
  }
  return torque;
}

Samples actingTorque(std::vector<double> held) {
  for (std::size_t i = held.size() - 1; i > 0; --i) {
    held[i] = 0.5 * (held[i] + held[i - 1]);
  }
  return held;
}

// Rows of all joints, thinned out, each in units of its joint's noise.
Eigen::VectorXd rows(const std::array<Samples, kJoints>& signal, const PerJoint& unit, std::size_t joints) {
  std::vector<double> stacked;
  for (std::size_t j = 0; j < joints; ++j) {
    for (std::size_t i = 0; i < signal[j].size(); i += kRowStep) {
      stacked.push_back(signal[j][i] / unit[j]);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(stacked.data(), static_cast<Eigen::Index>(stacked.size()));
}

// Columns: how the torque changes with what the body's nominal parameters can change.
Eigen::MatrixXd sensitivities(const Body& body, const Motion& motion, const Band& band,
                              const PerJoint& unit) {
  std::vector<Eigen::VectorXd> columns;
  for (const auto& [more, less] : nominalDirections(body)) {
    auto difference = bodyTorque(more, motion, band);
    const auto low = bodyTorque(less, motion, band);
    for (std::size_t j = 0; j < body.joints(); ++j) {
      difference[j] = offline::difference(difference[j], low[j]);
    }
    Eigen::VectorXd column = rows(difference, unit, body.joints());
    // A link on the first joint has parameters that no motion shows.
    if (const double size = column.norm(); size > 0.0) {
      columns.push_back(column / size);
    }
  }
  Eigen::MatrixXd matrix(columns.front().size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    matrix.col(static_cast<Eigen::Index>(i)) = columns[i];
  }
  return matrix;
}

}  // namespace

Analysis analyse(const Rig& rig, const Run& run, double band_Hz) {
  const std::size_t joints = rig.body.joints();
  const Band band(band_Hz);
  const Motion exact = motionOf(run.encoder_rad, joints);
  const Motion seen = motionOf(run.recording.position_rad, joints);
  const auto exact_torque = bodyTorque(rig.body, exact, band);
  const auto seen_torque = bodyTorque(rig.body, seen, band);
  Analysis result;
  result.rate_Hz = kRate_Hz;
  for (std::size_t j = 0; j < joints; ++j) {
    const Samples commanded = band.ofRecorded(actingTorque(run.command_Nm[j]));
    const Samples recorded = band.ofRecorded(actingTorque(run.recording.torque_Nm[j]));
    const Samples human = band.ofRecorded(run.human_Nm[j]);
    for (std::size_t i = 0; i < human.size(); ++i) {
      const double effect_Nm = exact_torque[j][i] - commanded[i] - human[i];
      result.effect_Nm[j].push_back(effect_Nm);
      result.noise_Nm[j].push_back(recorded[i] - seen_torque[j][i] + effect_Nm);
    }
    result.noise_rms_Nm[j] = offline::rms(result.noise_Nm[j]);
  }
  const Eigen::VectorXd effect = rows(result.effect_Nm, result.noise_rms_Nm, joints);
  const double count = static_cast<double>(effect.size()) / static_cast<double>(joints);
  result.raw_strength = effect.norm() / std::sqrt(count);
  // Six parameters of a leg move only five combinations, ten of a chain's link seven at most.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> nominal;
  nominal.setThreshold(1e-8);
  const Eigen::MatrixXd columns = sensitivities(rig.body, exact, band, result.noise_rms_Nm);
  nominal.compute(columns);
  result.strength = (effect - columns * nominal.solve(effect)).norm() / std::sqrt(count);
  return result;
}

PerJoint heldoutNoise_Nm(const Analysis& analysis, double fraction) {
  PerJoint result{};
  for (std::size_t j = 0; j < kJoints; ++j) {
    const std::vector<double>& noise = analysis.noise_Nm[j];
    if (!noise.empty()) {
      const auto first = static_cast<std::size_t>((1.0 - fraction) * static_cast<double>(noise.size()));
      result[j] = offline::rms(std::span(noise).subspan(first));
    }
  }
  return result;
}

}  // namespace patella::bench
