#include "sim/field_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "sim/cia402_drive.hpp"
#include "sim/mit_motor.hpp"
#include "sim/odrive.hpp"

namespace patella::sim {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

std::int64_t nanoseconds(double seconds) noexcept {
  return std::llround(seconds * 1e9);
}

void require(bool sound, const char* name, double value, const char* expected) {
  if (!sound) {
    throw std::invalid_argument(std::string("drive model ") + name + " is " + std::to_string(value) +
                                ", expected " + expected);
  }
}

}  // namespace

FieldDrive::FieldDrive(const FieldDriveOptions& options) : options_(options), starved_at_ns_(kNever) {
  require(options.position_range_rad > 0.0, "position_range_rad", options.position_range_rad, "> 0");
  require(options.velocity_range_rad_s > 0.0, "velocity_range_rad_s", options.velocity_range_rad_s, "> 0");
  require(options.torque_range_Nm > 0.0, "torque_range_Nm", options.torque_range_Nm, "> 0");
  require(options.torque_limit_Nm >= 0.0, "torque_limit_Nm", options.torque_limit_Nm, ">= 0");
  require(options.bandwidth_Hz >= 0.0, "bandwidth_Hz", options.bandwidth_Hz, ">= 0");
  require(options.watchdog_s >= 0.0, "watchdog_s", options.watchdog_s, ">= 0");
  require(options.enable_delay_s >= 0.0, "enable_delay_s", options.enable_delay_s, ">= 0");
  require(options.heartbeat_period_s > 0.0, "heartbeat_period_s", options.heartbeat_period_s, "> 0");
  require(options.rated_torque_Nm > 0.0, "rated_torque_Nm", options.rated_torque_Nm, "> 0");
  require(options.rated_torque_unit_Nm > 0.0, "rated_torque_unit_Nm", options.rated_torque_unit_Nm, "> 0");
  require(options.gear > 0.0, "gear", options.gear, "> 0");
  require(options.direction == 1 || options.direction == -1, "direction", options.direction, "1 or -1");
  require(options.counts_per_turn > 0.0, "counts_per_turn", options.counts_per_turn, "> 0");
}

bool FieldDrive::accept(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
                        FrameSink& replies) noexcept PATELLA_NONBLOCKING {
  if (defect_.off || frame.error || frame.remote || frame.extended || frame.bus != options_.bus) {
    return false;
  }
  return hear(frame, joint, now_ns, replies);
}

void FieldDrive::sample(const JointReading& joint, std::int64_t now_ns,
                        FrameSink& frames) noexcept PATELLA_NONBLOCKING {
  if (!defect_.off && !defect_.silent) {
    report(joint, now_ns, frames);
  }
}

void FieldDrive::watch(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  if (now_ns >= starved_at_ns_) {
    starved_at_ns_ = kNever;
    if (phase_ == Phase::kEnabled) {
      ++watchdog_trips_;
      target_Nm_ = torque_Nm_ = 0.0;
      starved();
      apply();
    }
  }
  if (phase_ == Phase::kEnabling && now_ns >= enabled_at_ns_) {
    phase_ = Phase::kEnabled;
  }
}

std::int64_t FieldDrive::deadline_ns() const noexcept {
  return std::min(starved_at_ns_, phase_ == Phase::kEnabling ? enabled_at_ns_ : kNever);
}

void FieldDrive::advance(double dt_s) noexcept PATELLA_NONBLOCKING {
  if (options_.bandwidth_Hz == 0.0 || phase_ != Phase::kEnabled) {
    return;
  }
  const double kept = std::exp(-2.0 * std::numbers::pi * options_.bandwidth_Hz * dt_s);
  torque_Nm_ = target_Nm_ + kept * (torque_Nm_ - target_Nm_);
  apply();
}

void FieldDrive::defect(const FieldDriveDefect& defect, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  const bool began = defect.leaves && !defect_.leaves;
  const bool died = defect.off && !defect_.off;
  defect_ = defect;
  if (began || died) {
    leave();
  }
  if (died) {
    forget();
    starved_at_ns_ = kNever;
  }
  watch(now_ns);
  apply();
}

void FieldDrive::enter(std::int64_t now_ns) noexcept {
  if (defect_.ignores_enter || defect_.faulty || phase_ != Phase::kDisabled) {
    return;
  }
  phase_ = Phase::kEnabling;
  enabled_at_ns_ = now_ns + nanoseconds(options_.enable_delay_s);
  watch(now_ns);
}

void FieldDrive::leave() noexcept {
  phase_ = Phase::kDisabled;
  target_Nm_ = torque_Nm_ = 0.0;
  apply();
}

void FieldDrive::command(double torque_Nm, std::int64_t now_ns) noexcept {
  ++commands_;
  if (options_.watchdog_s > 0.0) {
    starved_at_ns_ = now_ns + nanoseconds(options_.watchdog_s);
  }
  const bool acts = phase_ == Phase::kEnabled;
  target_Nm_ = acts ? std::clamp(torque_Nm, -options_.torque_limit_Nm, options_.torque_limit_Nm) : 0.0;
  if (options_.bandwidth_Hz == 0.0 || !acts) {
    torque_Nm_ = target_Nm_;
  }
  apply();
}

void FieldDrive::apply() noexcept {
  const bool acts = phase_ == Phase::kEnabled && !defect_.faulty;
  applied_Nm_ = acts ? defect_.gain * torque_Nm_ + defect_.extra_Nm : 0.0;
}

std::unique_ptr<FieldDrive> makeFieldDrive(const FieldDriveOptions& options) {
  if (options.kind == FieldDriveKind::kMit) {
    return std::make_unique<MitMotor>(options);
  }
  if (options.kind == FieldDriveKind::kCia402) {
    return std::make_unique<Cia402Drive>(options);
  }
  return std::make_unique<Odrive>(options);
}

}  // namespace patella::sim
