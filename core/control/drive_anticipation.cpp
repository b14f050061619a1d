#include "core/control/drive_anticipation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.hpp"

namespace patella::control {

double DriveAnticipation::lateness_s(const model::DriveLateness& lateness, double period_s) noexcept {
  // A lag of two ticks or less cannot be shortened by commands that change once a tick.
  const double left_s = std::max(lateness.lag_s / kQuickening, 2.0 * period_s);
  return lateness.delay_s + std::min(lateness.lag_s, left_s);
}

DriveAnticipation::DriveAnticipation(int joints, const std::array<model::DriveLateness, kMaxJoints>& lateness,
                                     double period_s)
    : drives_(static_cast<std::size_t>(joints)), period_s_(period_s) {
  requireRange("joints", joints, 1, kMaxJoints);
  double longest_s = 0.0;
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    const std::string of = " of joint " + std::to_string(joint + 1) + ", s";
    requireRange("delay" + of, lateness[joint].delay_s, 0.0, kLongest_s);
    requireRange("lag" + of, lateness[joint].lag_s, 0.0, kLongest_s);
    Drive& drive = drives_[joint];
    drive.late_s = lateness_s(lateness[joint], period_s);
    longest_s = std::max(longest_s, drive.late_s);
    horizons_s_.push_back(drive.late_s);
    if (lateness[joint].lag_s > 0.0) {
      drive.quickening = lateness[joint].lag_s / (drive.late_s - lateness[joint].delay_s);
      drive.approach = -std::expm1(-period_s / lateness[joint].lag_s);
    }
  }
  needed_ = longest_s > 0.0;
  std::sort(horizons_s_.begin(), horizons_s_.end());
  horizons_s_.erase(std::unique(horizons_s_.begin(), horizons_s_.end()), horizons_s_.end());
  for (Drive& drive : drives_) {
    drive.demands_Nm.assign(static_cast<std::size_t>(std::ceil(longest_s / period_s)) + 1, 0.0);
  }
}

JointVector DriveAnticipation::quickening(const JointVector& demand_Nm) const noexcept PATELLA_NONBLOCKING {
  JointVector more_Nm(demand_Nm.size());
  for (Eigen::Index joint = 0; joint < demand_Nm.size(); ++joint) {
    const Drive& drive = drives_[static_cast<std::size_t>(joint)];
    more_Nm[joint] = (drive.quickening - 1.0) * (demand_Nm[joint] - drive.arriving_Nm);
  }
  return more_Nm;
}

// Limits may have cut what was asked for: w is what the command amounts to.
void DriveAnticipation::commanded(const JointVector& torque_Nm) noexcept PATELLA_NONBLOCKING {
  const std::size_t length = drives_[0].demands_Nm.size();
  newest_ = (newest_ + length - 1) % length;
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    Drive& drive = drives_[joint];
    const double missing_Nm = torque_Nm[static_cast<Eigen::Index>(joint)] - drive.arriving_Nm;
    drive.demands_Nm[newest_] = drive.arriving_Nm + missing_Nm / drive.quickening;
    drive.arriving_Nm += drive.approach * missing_Nm;
  }
}

// A demand was held for a period: that of age a arrives at h − a, where the drive's own lateness is h.
DriveAnticipation::Moments DriveAnticipation::moments(const Drive& drive, double horizon_s) const noexcept {
  const std::vector<double>& demands = drive.demands_Nm;
  Moments sum;
  const auto add = [&](double torque_Nm, double from_s, double to_s) {
    const double from = std::clamp(from_s, 0.0, horizon_s);
    const double to = std::clamp(to_s, from, horizon_s);
    sum.first += torque_Nm * (to - from);
    sum.second += 0.5 * torque_Nm * (to - from) * (2.0 * horizon_s - to - from);
  };
  // Beyond what is on its way, the newest is taken to stay.
  add(demands[newest_], drive.late_s, horizon_s);
  for (std::size_t age = 0; static_cast<double>(age) * period_s_ < drive.late_s; ++age) {
    const double young_s = static_cast<double>(age) * period_s_;
    add(demands[(newest_ + age) % demands.size()], drive.late_s - std::min(young_s + period_s_, drive.late_s),
        drive.late_s - young_s);
  }
  return sum;
}

void DriveAnticipation::lookAhead(const model::ModelTerms& terms, const JointVector& f_hat, double horizon_s,
                                  JointVector& q, JointVector& dq) const noexcept PATELLA_NONBLOCKING {
  // What the model's effects make of late torque is left out: it is what is counted here.
  const JointVector passive = f_hat - terms.inverse_inertia * (terms.bias_Nm + terms.drive_Nm);
  JointVector first(f_hat.size());
  JointVector second(f_hat.size());
  for (Eigen::Index joint = 0; joint < f_hat.size(); ++joint) {
    const Moments torque = moments(drives_[static_cast<std::size_t>(joint)], horizon_s);
    first[joint] = torque.first;
    second[joint] = torque.second;
  }
  q += horizon_s * dq + 0.5 * horizon_s * horizon_s * passive + terms.inverse_inertia * second;
  dq += horizon_s * passive + terms.inverse_inertia * first;
}

}  // namespace patella::control
