#include "core/estimation/extended_state_observer.hpp"

#include <cmath>
#include <numbers>

#include "core/bounds/bounds.hpp"

namespace patella::estimation {

ExtendedStateObserver::ExtendedStateObserver(const PerJoint& bandwidth_Hz) : bandwidth_Hz_(bandwidth_Hz) {
  requireBound(boundOf("estimation.bandwidth_Hz"), bandwidth_Hz);
}

void ExtendedStateObserver::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  has_velocity_ = input.has_velocity;
  known_.reset(input);
  first_ = has_velocity_ ? input.dq : input.q;
  third_ = JointVector::Zero(input.q.size());
  second_ = has_velocity_ ? third_ : input.dq;
}

JointVector ExtendedStateObserver::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const double dt = input.dt_s;
  const JointVector known = known_.advance(input);
  // f_u is the second of the three where velocity is measured, otherwise the third.
  const JointVector first_rate = has_velocity_ ? JointVector(second_ + known) : second_;
  const JointVector second_rate = has_velocity_ ? third_ : JointVector(third_ + known);
  first_ += dt * (first_rate + 0.5 * dt * second_rate);
  second_ += dt * second_rate;

  const JointVector error = (has_velocity_ ? input.dq : input.q) - first_;
  for (Eigen::Index joint = 0; joint < error.size(); ++joint) {
    const double w = 2.0 * std::numbers::pi * bandwidth_Hz_[static_cast<std::size_t>(joint)];
    const double pole = std::exp(-w * dt);
    const double rest = 1.0 - pole;
    first_[joint] += (1.0 - pole * pole * pole) * error[joint];
    second_[joint] += 1.5 * rest * rest * (1.0 + pole) / dt * error[joint];
    third_[joint] += rest * rest * rest / (dt * dt) * error[joint];
  }
  return has_velocity_ ? second_ : third_;
}

}  // namespace patella::estimation
