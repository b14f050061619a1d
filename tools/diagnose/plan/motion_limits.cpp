#include "tools/diagnose/plan/motion_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>

namespace patella::diagnose {
namespace {

/// Largest first, second and third derivative of the minimum-jerk polynomial over its duration.
constexpr double kBlendRate = 1.875;
constexpr double kBlendAcceleration = 5.7735026918962573;  // 10 / √3
constexpr double kBlendJerk = 60.0;

/// Bounds of the second derivatives of position and speed.
struct Curvature {
  double of_position = 0.0;  ///< rad/s²
  double of_speed = 0.0;     ///< rad/s³
};

// Σ amplitude · ωⁿ bounds the n-th derivative of a multisine; the product rule adds what the blend brings.
Curvature curvatureOf(const control::JointMotion& motion, double start_rad, double blend_s) {
  const auto* waves = std::get_if<control::MultisineMotion>(&motion);
  if (waves == nullptr) {
    throw std::logic_error("limitUse: a planned motion is a multisine");
  }
  double span = std::abs(waves->offset_rad - start_rad), rate = 0.0, acceleration = 0.0, jerk = 0.0;
  for (const control::SineComponent& component : waves->components) {
    const double omega = 2.0 * std::numbers::pi * component.frequency_Hz;
    span += component.amplitude_rad;
    rate += component.amplitude_rad * omega;
    acceleration += component.amplitude_rad * omega * omega;
    jerk += component.amplitude_rad * omega * omega * omega;
  }
  const double w1 = kBlendRate / blend_s;
  const double w2 = kBlendAcceleration / (blend_s * blend_s);
  const double w3 = kBlendJerk / (blend_s * blend_s * blend_s);
  return {.of_position = w2 * span + 2.0 * w1 * rate + acceleration,
          .of_speed = w3 * span + 3.0 * w2 * rate + 3.0 * w1 * acceleration + jerk};
}

double between(double curvature, double step_s) {
  return step_s * step_s / 8.0 * curvature;
}

}  // namespace

MotionLimits usableLimits(const safety::SafetyLimits& limits, int joints) {
  MotionLimits usable;
  for (int j = 0; j < joints; ++j) {
    const safety::JointLimits& joint = limits.joint[static_cast<std::size_t>(j)];
    const double margin = joint.soft_margin_rad + kRangeMargin * (joint.q_max_rad - joint.q_min_rad);
    usable.push_back({.lowest_rad = joint.q_min_rad + margin,
                      .highest_rad = joint.q_max_rad - margin,
                      .speed_rad_s = kSpeedShare * joint.velocity_rad_s,
                      .torque_Nm = kTorqueShare * joint.torque_Nm});
    if (!(usable.back().lowest_rad < usable.back().highest_rad)) {
      throw std::invalid_argument(fmt::format(
          "joint {}: range {} to {} rad, expected more than its margins of {:.3g} rad at each end", j + 1,
          joint.q_min_rad, joint.q_max_rad, margin));
    }
  }
  return usable;
}

TorqueAlong::TorqueAlong(const model::ModelDescription& model) : dynamics_(model::makeModel(model)) {}

JointVector TorqueAlong::at(const JointVector& q, const JointVector& dq, const JointVector& ddq,
                            double time_s, bool first) {
  model::EffectInput input{.q = q, .dq = dq, .torque_Nm = JointVector::Zero(q.size()), .time_s = time_s};
  // Friction of loaded gears depends on the torque that the rigid body needs.
  const model::RigidBodyTerms body = dynamics_.mechanism().rigidBody(q, dq);
  input.torque_Nm = body.inertia * ddq + body.bias_Nm;
  if (first) {
    dynamics_.reset(input);
  } else {
    dynamics_.advance(input, time_s - last_s_);
  }
  last_s_ = time_s;
  return dynamics_.inverseDynamics(input, ddq);
}

JointVector TorqueAlong::acceleration(const JointVector& q, const JointVector& dq,
                                      const JointVector& torque_Nm) {
  const model::EffectInput input{.q = q, .dq = dq, .torque_Nm = torque_Nm};
  dynamics_.reset(input);
  const model::ModelTerms terms = dynamics_.evaluate(input);
  return terms.inverse_inertia * torque_Nm + terms.f;
}

double EndPointAlong::shareAt(const model::Mechanism& mechanism, const Reach& reach, const JointVector& q) {
  const Jacobian jacobian = mechanism.jacobian(q);
  if (calls_ == 0) {
    way_m_ = SpaceVector::Zero(mechanism.dimensions());
    before_last_way_m_ = last_way_m_ = way_m_;
  } else {
    before_last_way_m_ = last_way_m_;
    last_way_m_ = way_m_;
    way_m_ += 0.5 * (jacobian + last_) * (q - last_q_);
  }
  last_ = jacobian;
  last_q_ = q;
  ++calls_;
  double share = 0.0;
  for (Eigen::Index k = 0; k < way_m_.size(); ++k) {
    const double bend = std::abs(way_m_[k] - 2.0 * last_way_m_[k] + before_last_way_m_[k]) / 8.0;
    share =
        std::max({share, (way_m_[k] + bend) / reach.highest_m[k], (way_m_[k] - bend) / reach.lowest_m[k]});
  }
  return share;
}

LimitUse limitUse(const control::ReferenceSettings& reference, const JointVector& start_rad,
                  const MotionLimits& limits, const std::optional<Reach>& reach, TorqueAlong& torque,
                  double duration_s, double rate_Hz) {
  const auto joints = static_cast<Eigen::Index>(limits.size());
  control::ReferenceTrajectory trajectory(static_cast<int>(joints), reference);
  trajectory.start(start_rad);
  const double step_s = 1.0 / rate_Hz;
  std::vector<Curvature> curvature;
  for (Eigen::Index j = 0; j < joints; ++j) {
    curvature.push_back(
        curvatureOf(reference.motion[static_cast<std::size_t>(j)], start_rad[j], reference.blend_s));
  }
  LimitUse use;
  JointVector last = JointVector::Zero(joints), before_last = last;
  JointVector peak_Nm = JointVector::Zero(joints), bend_Nm = JointVector::Zero(joints);
  EndPointAlong end_point;
  const auto ticks = static_cast<int>(std::ceil(duration_s * rate_Hz));
  for (int i = 0; i <= ticks; ++i) {
    const control::ReferencePoint point = trajectory.at(i * step_s);
    const JointVector now = torque.at(point.q, point.dq, point.ddq, i * step_s, i == 0);
    for (Eigen::Index j = 0; j < joints; ++j) {
      const UsableRange& limit = limits[static_cast<std::size_t>(j)];
      const Curvature& bend = curvature[static_cast<std::size_t>(j)];
      const double middle = 0.5 * (limit.lowest_rad + limit.highest_rad);
      use.position =
          std::max(use.position, (std::abs(point.q[j] - middle) + between(bend.of_position, step_s)) /
                                     (limit.highest_rad - middle));
      use.speed =
          std::max(use.speed, (std::abs(point.dq[j]) + between(bend.of_speed, step_s)) / limit.speed_rad_s);
    }
    if (reach) {
      use.reach = std::max(use.reach, end_point.shareAt(torque.mechanism(), *reach, point.q));
    }
    peak_Nm = peak_Nm.cwiseMax(now.cwiseAbs());
    if (i > 1) {
      bend_Nm = bend_Nm.cwiseMax((now - 2.0 * last + before_last).cwiseAbs());
    }
    before_last = last;
    last = now;
  }
  for (Eigen::Index j = 0; j < joints; ++j) {
    const double share = (peak_Nm[j] + bend_Nm[j] / 8.0) / limits[static_cast<std::size_t>(j)].torque_Nm;
    use.torque = std::max(use.torque, share);
  }
  return use;
}

}  // namespace patella::diagnose
