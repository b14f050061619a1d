#include "tools/diagnose/plan/motion_family.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace patella::diagnose {
namespace {

/// Effects with memory are defined for steps of up to 10 ms.
constexpr double kStep_s = 0.01;
/// Halvings by which a size is found that fits: to 1 %.
constexpr int kHalvings = 7;
/// Keeps divisions by what may be zero, and comparisons of equals, from the last bit.
constexpr double kNothing = 1e-9;
/// Frequencies are written with so many digits. Within a minute a phase is off by 0.02 rad for it.
constexpr double kFrequencyStep_Hz = 1e-4;

double periodOf_s(const PlanTiming& timing) {
  return (timing.duration_s - timing.blend_s) / kPeriods;
}

// Minimum jerk, as the loop's reference blends (core/control/reference_trajectory.cpp). The loop's own is
// what a plan is checked with in the end.
struct Blend {
  double weight, rate, acceleration;
};
Blend blendAt(double t_s, double blend_s) {
  const double x = std::clamp(t_s / blend_s, 0.0, 1.0);
  return {x * x * x * (10.0 + x * (6.0 * x - 15.0)), 30.0 * x * x * (1.0 - x) * (1.0 - x) / blend_s,
          60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (blend_s * blend_s)};
}

}  // namespace

std::vector<std::vector<double>> harmonicsOf(const PlanTiming& timing, int joints) {
  const double period_s = periodOf_s(timing);
  const auto highest = static_cast<int>(std::floor(timing.highest_Hz * period_s + kNothing));
  const int harmonics = timing.harmonics.value_or(std::clamp(highest, 1, kUsualHarmonics));
  if (highest < harmonics) {
    const double least_s = harmonics / timing.highest_Hz;
    throw std::invalid_argument(fmt::format(
        "--duration: value {} s with --blend {} s, expected at least {:.4g} s: {} periods of {:.4g} s after "
        "the blend, in which --harmonics {} fit up to --highest {} Hz",
        timing.duration_s, timing.blend_s, timing.blend_s + kPeriods * least_s, kPeriods, least_s, harmonics,
        timing.highest_Hz));
  }
  const double steps = std::max(1.0, static_cast<double>(harmonics * joints - 1));
  std::vector<std::vector<double>> all;
  for (int j = 0; j < joints; ++j) {
    std::vector<double> own;
    int last = 0;
    for (int k = 0; k < harmonics; ++k) {
      const double place = static_cast<double>(k * joints + j) / steps;
      const auto wanted = static_cast<int>(std::lround(std::pow(static_cast<double>(highest), place)));
      // As many have to find room above it as follow.
      last = std::clamp(wanted, last + 1, highest - (harmonics - 1 - k));
      own.push_back(std::round(last / period_s / kFrequencyStep_Hz) * kFrequencyStep_Hz);
    }
    all.push_back(std::move(own));
  }
  return all;
}

MotionFamily::MotionFamily(const PlanTiming& timing, std::vector<std::vector<double>> frequency_Hz,
                           const MotionLimits& limits, const std::optional<Reach>& reach,
                           const JointVector& start_rad, const model::ModelDescription& model)
    : timing_(timing),
      frequency_Hz_(std::move(frequency_Hz)),
      limits_(limits),
      reach_(reach),
      start_rad_(start_rad),
      torque_(model),
      harmonics_(static_cast<Eigen::Index>(frequency_Hz_.front().size())),
      samples_(static_cast<Eigen::Index>(std::floor(timing.duration_s / kStep_s)) + 1) {
  for (int j = 0; j < joints(); ++j) {
    const UsableRange& limit = limits_[static_cast<std::size_t>(j)];
    if (!(start_rad_[j] >= limit.lowest_rad && start_rad_[j] <= limit.highest_rad)) {
      throw std::invalid_argument(fmt::format(
          "joint {}: the start at {:.4g} rad, expected {:.4g} to {:.4g} rad, the range less its margins",
          j + 1, start_rad_[j], limit.lowest_rad, limit.highest_rad));
    }
  }
  weight_.resize(samples_);
  weight_rate_.resize(samples_);
  weight_acceleration_.resize(samples_);
  for (Eigen::Index i = 0; i < samples_; ++i) {
    const Blend blend = blendAt(static_cast<double>(i) * kStep_s, timing_.blend_s);
    weight_[i] = blend.weight;
    weight_rate_[i] = blend.rate;
    weight_acceleration_[i] = blend.acceleration;
  }
  for (const std::vector<double>& frequencies : frequency_Hz_) {
    omega_.push_back(2.0 * std::numbers::pi *
                     Eigen::Map<const Eigen::VectorXd>(frequencies.data(), harmonics_));
    Eigen::MatrixXd wave(samples_, 2 * harmonics_);
    for (Eigen::Index i = 0; i < samples_; ++i) {
      const Eigen::ArrayXd angle = omega_.back().array() * (static_cast<double>(i) * kStep_s);
      wave.row(i).head(harmonics_) = angle.sin();
      wave.row(i).tail(harmonics_) = angle.cos();
    }
    wave_.push_back(std::move(wave));
  }
}

Eigen::VectorXd MotionFamily::periods(int joint) const {
  return omega_[static_cast<std::size_t>(joint)] * (periodOf_s(timing_) / (2.0 * std::numbers::pi));
}

// Position and speed of a joint are its own, and go with its amplitudes, so that both are met at once.
FourierMotion MotionFamily::withinRanges(const Eigen::VectorXd& point) const {
  FourierMotion motion{.offset_rad = Eigen::VectorXd(joints()),
                       .amplitude_rad = Eigen::MatrixXd(2 * harmonics_, joints())};
  for (int j = 0; j < joints(); ++j) {
    const auto number = static_cast<std::size_t>(j);
    const UsableRange& limit = limits_[number];
    const Eigen::VectorXd shape = point.segment(firstAmplitude(j), 2 * harmonics_);
    const Eigen::VectorXd& omega = omega_[number];
    const Eigen::ArrayXd length =
        (shape.head(harmonics_).array().square() + shape.tail(harmonics_).array().square()).sqrt();
    const Eigen::VectorXd way = wave_[number] * shape;
    Eigen::VectorXd slope(2 * harmonics_);
    slope << -omega.cwiseProduct(shape.tail(harmonics_)), omega.cwiseProduct(shape.head(harmonics_));
    const Eigen::VectorXd speed = wave_[number] * slope;
    // Between two instants by no more than h²/8 · max|f''|.
    const double between = kStep_s * kStep_s / 8.0;
    const double bend = between * (length * omega.array().square()).sum();
    const double low = way.minCoeff() - bend, high = way.maxCoeff() + bend;
    const double fastest = speed.cwiseAbs().maxCoeff() + between * (length * omega.array().cube()).sum();
    const double room = limit.highest_rad - limit.lowest_rad;
    const double fill = std::clamp(point[j * numbersOfJoint() + 1], 0.05, 1.0);
    const double scale = std::min({fill * room / std::max(high - low, kNothing),
                                   limit.speed_rad_s / std::max(fastest, kNothing),
                                   std::numbers::pi / std::max(length.sum(), kNothing)});
    motion.amplitude_rad.col(j) = scale * shape;
    const double side = 0.5 * (1.0 + std::clamp(point[j * numbersOfJoint()], -1.0, 1.0));
    motion.offset_rad[j] = limit.lowest_rad - scale * low + side * (room - scale * (high - low));
  }
  return motion;
}

SampledMotion MotionFamily::sampled(const FourierMotion& motion) const {
  SampledMotion sampled{.step_s = kStep_s,
                        .q = Eigen::MatrixXd(samples_, joints()),
                        .dq = Eigen::MatrixXd(samples_, joints()),
                        .ddq = Eigen::MatrixXd(samples_, joints())};
  for (int j = 0; j < joints(); ++j) {
    const auto number = static_cast<std::size_t>(j);
    const Eigen::VectorXd& omega = omega_[number];
    const Eigen::VectorXd value = motion.amplitude_rad.col(j);
    Eigen::VectorXd rate(2 * harmonics_), acceleration(2 * harmonics_);
    rate << -omega.cwiseProduct(value.tail(harmonics_)), omega.cwiseProduct(value.head(harmonics_));
    acceleration << -omega.cwiseAbs2().cwiseProduct(value.head(harmonics_)),
        -omega.cwiseAbs2().cwiseProduct(value.tail(harmonics_));
    const Eigen::ArrayXd away = (wave_[number] * value).array() + (motion.offset_rad[j] - start_rad_[j]);
    const Eigen::ArrayXd speed = (wave_[number] * rate).array();
    sampled.q.col(j) = start_rad_[j] + weight_.array() * away;
    sampled.dq.col(j) = weight_rate_.array() * away + weight_.array() * speed;
    sampled.ddq.col(j) = weight_acceleration_.array() * away + 2.0 * weight_rate_.array() * speed +
                         weight_.array() * (wave_[number] * acceleration).array();
  }
  return sampled;
}

bool MotionFamily::fits(const SampledMotion& motion) {
  JointVector last, before_last, bend = JointVector::Zero(joints()), peak = bend;
  for (int j = 0; j < joints(); ++j) {
    const double fastest = motion.dq.col(j).cwiseAbs().maxCoeff();
    if (fastest > limits_[static_cast<std::size_t>(j)].speed_rad_s * (1.0 + kNothing)) {
      return false;
    }
  }
  EndPointAlong end_point;
  for (Eigen::Index i = 0; i < samples_; ++i) {
    if (reach_ && end_point.shareAt(torque_.mechanism(), *reach_, motion.q.row(i).transpose()) > 1.0) {
      return false;
    }
    const JointVector now =
        torque_.at(motion.q.row(i).transpose(), motion.dq.row(i).transpose(), motion.ddq.row(i).transpose(),
                   static_cast<double>(i) * kStep_s, i == 0);
    peak = peak.cwiseMax(now.cwiseAbs());
    if (i > 1) {
      bend = bend.cwiseMax((now - 2.0 * last + before_last).cwiseAbs());
    }
    before_last = last;
    last = now;
    for (int j = 0; j < joints(); ++j) {
      if (peak[j] + bend[j] / 8.0 > limits_[static_cast<std::size_t>(j)].torque_Nm) {
        return false;
      }
    }
  }
  return true;
}

std::optional<FourierMotion> MotionFamily::at(const Eigen::VectorXd& point) {
  FourierMotion motion = withinRanges(point);
  if (fits(sampled(motion))) {
    return motion;
  }
  const Eigen::MatrixXd whole = motion.amplitude_rad;
  double fitting = 0.0, too_large = 1.0;
  for (int halving = 0; halving < kHalvings; ++halving) {
    const double share = 0.5 * (fitting + too_large);
    motion.amplitude_rad = share * whole;
    (fits(sampled(motion)) ? fitting : too_large) = share;
  }
  if (fitting == 0.0) {
    return std::nullopt;
  }
  motion.amplitude_rad = fitting * whole;
  return motion;
}

control::ReferenceSettings MotionFamily::reference(const FourierMotion& motion) const {
  control::ReferenceSettings reference{.blend_s = timing_.blend_s};
  for (int j = 0; j < joints(); ++j) {
    control::MultisineMotion waves{.offset_rad = motion.offset_rad[j], .components = {}};
    for (Eigen::Index k = 0; k < harmonics_; ++k) {
      const double sine = motion.amplitude_rad(k, j), cosine = motion.amplitude_rad(harmonics_ + k, j);
      waves.components.push_back(
          {.amplitude_rad = std::hypot(sine, cosine),
           .frequency_Hz = frequency_Hz_[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)],
           .phase_rad = std::atan2(cosine, sine)});
    }
    reference.motion[static_cast<std::size_t>(j)] = std::move(waves);
  }
  return reference;
}

}  // namespace patella::diagnose
