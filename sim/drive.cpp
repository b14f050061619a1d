#include "sim/drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "sim/random_streams.hpp"

namespace patella::sim {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

void requireAtLeastZero(double value, const char* name) {
  if (!(value >= 0.0)) {
    throw std::invalid_argument(std::string("drive ") + name + " is " + std::to_string(value) +
                                ", expected >= 0");
  }
}

}  // namespace

Drive::Drive(const DriveOptions& options, int joints, std::uint64_t seed)
    : options_(options),
      random_(seed, kDriveStream),
      watchdog_ns_(std::llround(options.watchdog_s * 1e9)),
      deadline_ns_(kNever),
      target_Nm_(JointVector::Zero(joints)),
      torque_Nm_(JointVector::Zero(joints)),
      applied_Nm_(JointVector::Zero(joints)) {
  for (const double limit : options.torque_limit_Nm) {
    requireAtLeastZero(limit, "torque_limit_Nm");
  }
  requireAtLeastZero(options.bandwidth_Hz, "bandwidth_Hz");
  requireAtLeastZero(options.report_noise_sd_Nm, "report_noise_sd_Nm");
  if (!(options.watchdog_s > 0.0)) {
    throw std::invalid_argument("drive watchdog_s is " + std::to_string(options.watchdog_s) +
                                ", expected > 0");
  }
}

void Drive::command(const JointVector& torque_Nm, bool enable,
                    std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  fault_ = DriveFault::kNone;
  deadline_ns_ = now_ns + watchdog_ns_;
  if (!enable) {
    cut();
    return;
  }
  enabled_ = true;
  for (Eigen::Index i = 0; i < target_Nm_.size(); ++i) {
    const double limit = options_.torque_limit_Nm[static_cast<std::size_t>(i)];
    target_Nm_(i) = std::clamp(torque_Nm(i), -limit, limit);
  }
  if (options_.bandwidth_Hz == 0.0) {
    torque_Nm_ = target_Nm_;
  }
  apply();
}

void Drive::disturb(const DriveDisturbance& disturbance) noexcept PATELLA_NONBLOCKING {
  disturbance_ = disturbance;
  apply();
}

void Drive::restart() noexcept PATELLA_NONBLOCKING {
  cut();
  fault_ = DriveFault::kNone;
  deadline_ns_ = kNever;
}

void Drive::watch(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  if (now_ns < deadline_ns_) {
    return;
  }
  // A drive that was never enabled has nothing to lose, but a silent controller is reported all the same.
  cut();
  fault_ = DriveFault::kWatchdog;
  deadline_ns_ = kNever;
  ++watchdog_trips_;
}

void Drive::advance(double dt_s) noexcept PATELLA_NONBLOCKING {
  if (options_.bandwidth_Hz == 0.0 || !enabled_) {
    return;
  }
  const double kept = std::exp(-2.0 * std::numbers::pi * options_.bandwidth_Hz * dt_s);
  torque_Nm_ = target_Nm_ + kept * (torque_Nm_ - target_Nm_);
  apply();
}

JointVector Drive::reportedTorque() noexcept PATELLA_NONBLOCKING {
  JointVector reported = applied_Nm_;
  for (Eigen::Index i = 0; i < reported.size(); ++i) {
    reported(i) += options_.report_noise_sd_Nm * random_.gaussian();
  }
  return reported;
}

void Drive::cut() noexcept {
  enabled_ = false;
  target_Nm_.setZero();
  torque_Nm_.setZero();
  apply();
}

void Drive::apply() noexcept {
  applied_Nm_ = torque_Nm_;
  if (!enabled_ || disturbance_ == DriveDisturbance{}) {
    return;
  }
  for (Eigen::Index i = 0; i < applied_Nm_.size(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    applied_Nm_(i) = disturbance_.gain[joint] * torque_Nm_(i) + disturbance_.extra_Nm[joint];
  }
}

}  // namespace patella::sim
