#include "core/control/reference_trajectory.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"

namespace patella::control {
namespace {

constexpr Bound kOffset = boundOf("reference.joint.offset_rad");
constexpr Bound kAmplitude = boundOf("reference.joint.amplitude_rad");
constexpr Bound kFrequency = boundOf("reference.joint.frequency_Hz");
constexpr Bound kPhase = boundOf("reference.joint.phase_rad");

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

void addSine(double amplitude_rad, double frequency_Hz, double phase_rad, double t_s, Sample& sum) noexcept {
  const double omega = 2.0 * std::numbers::pi * frequency_Hz;
  const double angle = omega * t_s + phase_rad;
  const double sine = amplitude_rad * std::sin(angle);
  sum.value += sine;
  sum.rate += omega * amplitude_rad * std::cos(angle);
  sum.acceleration -= omega * omega * sine;
}

Sample sinusoid(const SinusoidMotion& motion, double t_s) noexcept {
  Sample sample{.value = motion.offset_rad};
  addSine(motion.amplitude_rad, motion.frequency_Hz, motion.phase_rad, t_s, sample);
  return sample;
}

Sample multisine(const MultisineMotion& motion, double t_s) noexcept {
  Sample sample{.value = motion.offset_rad};
  for (const SineComponent& component : motion.components) {
    addSine(component.amplitude_rad, component.frequency_Hz, component.phase_rad, t_s, sample);
  }
  return sample;
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
  if (const auto* waves = std::get_if<MultisineMotion>(&motion)) {
    return blend(start, minimumJerk(t_s, blend_s), multisine(*waves, t_s));
  }
  const auto* hold = std::get_if<HoldMotion>(&motion);
  return blend(start, minimumJerk(t_s, blend_s), {.value = hold->position_rad.value_or(start)});
}

void validate(const MultisineMotion& motion, const std::string& prefix) {
  requireBound(kOffset, motion.offset_rad, prefix + "offset_rad");
  requireRange(prefix + "components", static_cast<double>(motion.components.size()), 1.0,
               static_cast<double>(MultisineMotion::kMaxComponents));
  double sum_rad = 0.0;
  for (std::size_t k = 0; k < motion.components.size(); ++k) {
    const std::string suffix = "[" + std::to_string(k + 1) + "]";
    const SineComponent& component = motion.components[k];
    requireBound(kAmplitude, component.amplitude_rad, prefix + "amplitude_rad" + suffix);
    requireBound(kFrequency, component.frequency_Hz, prefix + "frequency_Hz" + suffix);
    requireBound(kPhase, component.phase_rad, prefix + "phase_rad" + suffix);
    sum_rad += component.amplitude_rad;
  }
  requireBound(kAmplitude, sum_rad, prefix + "sum of amplitude_rad");
}

void validate(const JointMotion& motion, const std::string& prefix) {
  if (const auto* move = std::get_if<MoveMotion>(&motion)) {
    requireBound(boundOf("reference.joint.target_rad"), move->target_rad, prefix + "target_rad");
    requireBound(boundOf("reference.joint.duration_s"), move->duration_s, prefix + "duration_s");
  } else if (const auto* wave = std::get_if<SinusoidMotion>(&motion)) {
    requireBound(kOffset, wave->offset_rad, prefix + "offset_rad");
    requireBound(kAmplitude, wave->amplitude_rad, prefix + "amplitude_rad");
    requireBound(kFrequency, wave->frequency_Hz, prefix + "frequency_Hz");
    requireBound(kPhase, wave->phase_rad, prefix + "phase_rad");
  } else if (const auto* waves = std::get_if<MultisineMotion>(&motion)) {
    validate(*waves, prefix);
  } else if (const auto* hold = std::get_if<HoldMotion>(&motion); hold->position_rad.has_value()) {
    requireBound(boundOf("reference.joint.position_rad"), *hold->position_rad, prefix + "position_rad");
  }
}

}  // namespace

double schroederPhase_rad(std::size_t index, std::size_t count) noexcept {
  const auto k = static_cast<double>(index);
  return std::fmod(-std::numbers::pi * k * (k + 1.0) / static_cast<double>(count), 2.0 * std::numbers::pi);
}

ReferenceTrajectory::ReferenceTrajectory(int joints, const ReferenceSettings& settings)
    : settings_(settings), start_() {
  requireRange("joints", joints, 1, kMaxJoints);
  requireBound(boundOf("reference.blend_s"), settings.blend_s);
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
