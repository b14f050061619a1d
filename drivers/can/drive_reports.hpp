// All that the drives reported within a tick, not only the newest of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/measurement.hpp"

namespace patella::can {

/// A wrong report that a right one follows within the same tick is a wrong report all the same.
class DriveReports {
 public:
  void torque(Eigen::Index joint, double torque_Nm) noexcept {
    Span& span = torque_Nm_[static_cast<std::size_t>(joint)];
    span.lowest = span.fresh ? std::min(span.lowest, torque_Nm) : torque_Nm;
    span.highest = span.fresh ? std::max(span.highest, torque_Nm) : torque_Nm;
    span.newest = torque_Nm;
    span.fresh = true;
  }
  void enabled(std::size_t joint, bool enabled) noexcept { enabled_[joint].note(enabled); }
  void fault(std::size_t joint, bool fault) noexcept { fault_[joint].note(fault); }

  /// Ends the tick: fills in what the drives said in it, or last said. True where one reported a fault.
  bool finish(Measurement& measurement) noexcept {
    for (Eigen::Index joint = 0; joint < measurement.drive_torque_Nm.size(); ++joint) {
      Span& span = torque_Nm_[static_cast<std::size_t>(joint)];
      measurement.drive_torque_Nm[joint] = span.newest;
      measurement.lowest_drive_torque_Nm[joint] = span.fresh ? span.lowest : span.newest;
      measurement.highest_drive_torque_Nm[joint] = span.fresh ? span.highest : span.newest;
      span.fresh = false;
    }
    bool had_fault = false;
    for (std::size_t joint = 0; joint < static_cast<std::size_t>(measurement.drive_torque_Nm.size());
         ++joint) {
      EnabledReport& report = measurement.drive_enabled[joint];
      report.was_enabled = enabled_[joint].was(true);
      report.was_disabled = enabled_[joint].was(false);
      had_fault = had_fault || fault_[joint].was(true);
      enabled_[joint].next();
      fault_[joint].next();
    }
    return had_fault;
  }

 private:
  struct Span {
    double newest = 0.0, lowest = 0.0, highest = 0.0;
    bool fresh = false;
  };
  class Flag {
   public:
    void note(bool value) noexcept {
      newest_ = value;
      seen_[value ? 1 : 0] = true;
    }
    bool was(bool value) const noexcept {
      return seen_[value ? 1 : 0] || (newest_ == value && !seen_[value ? 0 : 1]);
    }
    void next() noexcept { seen_ = {}; }

   private:
    bool newest_ = false;
    std::array<bool, 2> seen_{};  ///< in this tick
  };
  std::array<Span, kMaxJoints> torque_Nm_{};
  std::array<Flag, kMaxJoints> enabled_{}, fault_{};
};

}  // namespace patella::can
