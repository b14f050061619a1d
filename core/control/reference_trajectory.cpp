#include "core/control/reference_trajectory.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "core/check.hpp"

namespace patella::control {
namespace {

constexpr double kMaxAngle_rad = 2.0 * std::numbers::pi;
constexpr double kMaxFrequency_Hz = 5.0;
constexpr double kMinDuration_s = 0.1;
constexpr double kMaxDuration_s = 600.0;

/// A scalar function of time with its first two derivatives.
struct Sample {
  double value = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;
};

Sample minimumJerk(double t_s, double duration_s) noexcept {
  const double x = t_s / duration_s;
  if (!(x > 0.0)) {
    return {};
  }
  if (x >= 1.0) {
    return {.value = 1.0};
  }
  return {x * x * x * (10.0 + x * (6.0 * x - 15.0)), 30.0 * x * x * (1.0 - x) * (1.0 - x) / duration_s,
          60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (duration_s * duration_s)};
}

Sample sinusoid(const SinusoidMotion& motion, double t_s) noexcept {
  const double omega = 2.0 * std::numbers::pi * motion.frequency_Hz;
  const double angle = omega * t_s + motion.phase_rad;
  const double sine = motion.amplitude_rad * std::sin(angle);
  return {motion.offset_rad + sine, omega * motion.amplitude_rad * std::cos(angle), -omega * omega * sine};
}

/// start + weight · (target − start)
Sample blend(double start, const Sample& weight, const Sample& target) noexcept {
  const double distance = target.value - start;
  return {
      start + weight.value * distance, weight.rate * distance + weight.value * target.rate,
      weight.acceleration * distance + 2.0 * weight.rate * target.rate + weight.value * target.acceleration};
}

Sample evaluate(const JointMotion& motion, double start, double blend_s, double t_s) noexcept {
  if (const auto* move = std::get_if<MoveMotion>(&motion)) {
    return blend(start, minimumJerk(t_s, move->duration_s), {.value = move->target_rad});
  }
  if (const auto* wave = std::get_if<SinusoidMotion>(&motion)) {
    return blend(start, minimumJerk(t_s, blend_s), sinusoid(*wave, t_s));
  }
  const auto* hold = std::get_if<HoldMotion>(&motion);
  return blend(start, minimumJerk(t_s, blend_s), {.value = hold->position_rad.value_or(start)});
}

void validate(const JointMotion& motion, const std::string& prefix) {
  if (const auto* move = std::get_if<MoveMotion>(&motion)) {
    requireRange(prefix + "target_rad", move->target_rad, -kMaxAngle_rad, kMaxAngle_rad);
    requireRange(prefix + "duration_s", move->duration_s, kMinDuration_s, kMaxDuration_s);
  } else if (const auto* wave = std::get_if<SinusoidMotion>(&motion)) {
    requireRange(prefix + "offset_rad", wave->offset_rad, -kMaxAngle_rad, kMaxAngle_rad);
    requireRange(prefix + "amplitude_rad", wave->amplitude_rad, -kMaxAngle_rad, kMaxAngle_rad);
    requireRange(prefix + "frequency_Hz", wave->frequency_Hz, 0.0, kMaxFrequency_Hz);
    requireRange(prefix + "phase_rad", wave->phase_rad, -kMaxAngle_rad, kMaxAngle_rad);
  } else if (const auto* hold = std::get_if<HoldMotion>(&motion); hold->position_rad.has_value()) {
    requireRange(prefix + "position_rad", *hold->position_rad, -kMaxAngle_rad, kMaxAngle_rad);
  }
}

}  // namespace

ReferenceTrajectory::ReferenceTrajectory(int joints, const ReferenceSettings& settings)
    : settings_(settings), start_() {
  requireRange("joints", joints, 1, kMaxJoints);
  requireRange("reference.blend_s", settings.blend_s, kMinDuration_s, kMaxDuration_s);
  for (int j = 0; j < joints; ++j) {
    validate(settings.motion[static_cast<std::size_t>(j)], "reference.joint[" + std::to_string(j + 1) + "].");
  }
  start_ = JointVector::Zero(joints);
}

void ReferenceTrajectory::start(const JointVector& q) noexcept PATELLA_NONBLOCKING {
  start_ = q;
}

ReferencePoint ReferenceTrajectory::at(double t_s) const noexcept PATELLA_NONBLOCKING {
  const Eigen::Index joints = start_.size();
  ReferencePoint point{JointVector(joints), JointVector(joints), JointVector(joints)};
  for (Eigen::Index j = 0; j < joints; ++j) {
    const Sample sample =
        evaluate(settings_.motion[static_cast<std::size_t>(j)], start_[j], settings_.blend_s, t_s);
    point.q[j] = sample.value;
    point.dq[j] = sample.rate;
    point.ddq[j] = sample.acceleration;
  }
  return point;
}

}  // namespace patella::control
