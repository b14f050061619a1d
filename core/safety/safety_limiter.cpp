#include "core/safety/safety_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"

namespace patella::safety {
namespace {

constexpr double kSmallestRange_rad = 1e-6;

void validate(const JointLimits& limits, const std::string& prefix) {
  requireBound(boundOf("safety.torque_Nm"), limits.torque_Nm, prefix + "torque_Nm");
  requireBound(boundOf("safety.torque_rate_Nm_s"), limits.torque_rate_Nm_s, prefix + "torque_rate_Nm_s");
  requireBound(boundOf("safety.velocity_rad_s"), limits.velocity_rad_s, prefix + "velocity_rad_s");
  requireBound(boundOf("safety.q_min_rad"), limits.q_min_rad, prefix + "q_min_rad");
  requireBound(boundOf("safety.q_max_rad"), limits.q_max_rad, prefix + "q_max_rad");
  if (limits.q_max_rad < limits.q_min_rad + kSmallestRange_rad) {
    rejectValue(prefix + "q_max_rad", limits.q_max_rad,
                "more than q_min_rad, " + shortestText(limits.q_min_rad));
  }
  requireRange(prefix + "soft_margin_rad", limits.soft_margin_rad, boundOf("safety.soft_margin_rad").minimum,
               0.5 * (limits.q_max_rad - limits.q_min_rad));
}

}  // namespace

SafetyLimiter::SafetyLimiter(int joints, const SafetyLimits& limits) : joints_(joints) {
  requireRange("joints", joints, 1, kMaxJoints);
  requireBound(boundOf("safety.saturation_timeout_s"), limits.saturation_timeout_s);
  for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
    validate(limits.joint[j], "safety.joint[" + std::to_string(j + 1) + "].");
    joint_[j] = {.limits = limits.joint[j], .saturated = LeakyScore(limits.saturation_timeout_s)};
  }
}

bool SafetyLimiter::plausible(const JointVector& values) const noexcept {
  return values.size() == joints_ && values.allFinite();
}

LimiterOutput SafetyLimiter::apply(const JointVector& demand_Nm, const JointVector& q, const JointVector& dq,
                                   double dt_s) noexcept PATELLA_NONBLOCKING {
  LimiterOutput out{JointVector::Zero(joints_), {}, {}};
  if (!plausible(demand_Nm) || !plausible(q) || !plausible(dq) || !std::isfinite(dt_s)) {
    out.faults.add(Fault::kNotFinite);
  } else {
    const double step_s = std::clamp(dt_s, 0.0, kMaxStep_s);
    for (int j = 0; j < joints_; ++j) {
      Joint& joint = joint_[static_cast<std::size_t>(j)];
      out.limits[static_cast<std::size_t>(j)] = limitJoint(joint, demand_Nm[j], q[j], dq[j], step_s);
      out.torque_Nm[j] = joint.last_Nm;
      if (std::abs(dq[j]) > joint.limits.velocity_rad_s) {
        out.faults.add(Fault::kVelocityLimit);
      }
      if (q[j] < joint.limits.q_min_rad || q[j] > joint.limits.q_max_rad) {
        out.faults.add(Fault::kJointRange);
      }
      if (joint.saturated.exceeded()) {
        out.faults.add(Fault::kTorqueLimit);
      }
    }
  }
  if (out.faults.any()) {
    stop();
    out.torque_Nm.setZero();
    out.limits = {};
  }
  return out;
}

LimitSet SafetyLimiter::limitJoint(Joint& joint, double demand_Nm, double q, double dq,
                                   double dt_s) noexcept {
  const JointLimits& limits = joint.limits;
  // In the direction of the demand: room to the end of the range, and room to the velocity limit, 0…1.
  const auto rangeShare = [&](double sign) {
    const double room = sign > 0.0 ? limits.q_max_rad - q : q - limits.q_min_rad;
    return std::clamp(room / limits.soft_margin_rad, 0.0, 1.0);
  };
  const auto velocityShare = [&](double sign) {
    const double room = 1.0 - sign * dq / limits.velocity_rad_s;
    return std::clamp(room / (1.0 - kVelocityFade), 0.0, 1.0);
  };
  const auto bound = [&](double sign) { return limits.torque_Nm * rangeShare(sign) * velocityShare(sign); };
  const double lower = -bound(-1.0);
  const double upper = bound(1.0);

  LimitSet hit;
  const double magnitude = std::abs(demand_Nm);
  if (magnitude > limits.torque_Nm) {
    hit.add(Limit::kTorque);
  }
  joint.saturated.update(magnitude > limits.torque_Nm, dt_s);
  if (const double sign = demand_Nm > 0.0 ? 1.0 : -1.0; magnitude > bound(sign)) {
    if (rangeShare(sign) < 1.0) {
      hit.add(Limit::kSoftRange);
    }
    if (velocityShare(sign) < 1.0) {
      hit.add(Limit::kVelocity);
    }
  }

  const double wanted = std::clamp(demand_Nm, lower, upper);
  const double change = limits.torque_rate_Nm_s * dt_s;
  const double reachable = std::clamp(wanted, joint.last_Nm - change, joint.last_Nm + change);
  const double allowed = std::clamp(reachable, lower, upper);
  if (allowed != wanted) {
    hit.add(Limit::kTorqueRate);
  }
  joint.last_Nm = allowed;
  return hit;
}

void SafetyLimiter::stop() noexcept PATELLA_NONBLOCKING {
  for (Joint& joint : joint_) {
    joint.last_Nm = 0.0;
    joint.saturated.reset();
  }
}

}  // namespace patella::safety
