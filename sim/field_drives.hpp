// The drives of a rig whose joints have one of their own each.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/types.hpp"
#include "sim/field_drive.hpp"

namespace patella::sim {

class FieldDrives {
 public:
  /// Throws std::invalid_argument naming the option that is out of range.
  explicit FieldDrives(const std::vector<FieldDriveOptions>& options);

  bool any() const noexcept { return !drives_.empty(); }
  std::size_t size() const noexcept { return drives_.size(); }
  FieldDrive& operator[](std::size_t joint) noexcept { return *drives_[joint]; }
  const FieldDrive& operator[](std::size_t joint) const noexcept { return *drives_[joint]; }

  void watch(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;
  void advance(double dt_s) noexcept PATELLA_NONBLOCKING;
  /// The earliest of all; the largest integer where nothing is due.
  std::int64_t deadline_ns() const noexcept;
  const JointVector& torque() noexcept PATELLA_NONBLOCKING;
  std::uint64_t watchdogTrips() const noexcept;

 private:
  std::vector<std::unique_ptr<FieldDrive>> drives_;
  JointVector torque_Nm_;
};

}  // namespace patella::sim
