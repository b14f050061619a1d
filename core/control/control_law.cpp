#include "core/control/control_law.hpp"

#include <string>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"

namespace patella::control {
namespace {

void validate(const Bound& bound, const JointVector& values, int joints) {
  const std::string key(bound.name);
  if (values.size() != joints) {
    rejectValue("number of values of " + key, static_cast<double>(values.size()),
                "one per joint (" + std::to_string(joints) + ")");
  }
  for (int j = 0; j < joints; ++j) {
    requireBound(bound, values[j], key + "[" + std::to_string(j + 1) + "]");
  }
}

}  // namespace

ControlLaw::ControlLaw(int joints, const ControlGains& gains) : gains_(gains) {
  requireRange("joints", joints, 1, kMaxJoints);
  requireBound(boundOf("control.gravity"), gains.gravity);
  requireBound(boundOf("control.model"), gains.model);
  requireBound(boundOf("control.emg"), gains.emg);
  requireBound(boundOf("control.compensation"), gains.compensation);
  validate(boundOf("control.stiffness_Nm_rad"), gains.stiffness_Nm_rad, joints);
  validate(boundOf("control.damping_Nms_rad"), gains.damping_Nms_rad, joints);
}

ControlOutput ControlLaw::compute(const ControlInput& in) const noexcept PATELLA_NONBLOCKING {
  const JointVector zero = JointVector::Zero(gains_.stiffness_Nm_rad.size());
  ControlOutput out{zero, zero, zero, zero, zero, zero};
  if (gains_.gravity != 0.0) {
    out.gravity = gains_.gravity * in.gravity_Nm;
  }
  if (gains_.model != 0.0) {
    out.model.noalias() = in.terms.inertia * in.reference.ddq;
    out.model = gains_.model * (out.model + in.terms.bias_Nm + in.terms.drive_Nm - in.gravity_Nm);
  }
  if (gains_.emg != 0.0) {
    out.emg = gains_.emg * in.emg_torque_Nm;
  }
  for (Eigen::Index j = 0; j < zero.size(); ++j) {
    if (gains_.stiffness_Nm_rad[j] != 0.0) {
      out.impedance[j] += gains_.stiffness_Nm_rad[j] * (in.reference.q[j] - in.q[j]);
    }
    if (gains_.damping_Nms_rad[j] != 0.0) {
      out.impedance[j] += gains_.damping_Nms_rad[j] * (in.reference.dq[j] - in.dq[j]);
    }
  }
  if (gains_.compensation != 0.0) {
    out.compensation.noalias() = in.terms.inertia * in.f_hat;
    out.compensation *= -gains_.compensation;
  }
  out.total = out.gravity + out.model + out.emg + out.impedance + out.compensation;
  return out;
}

}  // namespace patella::control
