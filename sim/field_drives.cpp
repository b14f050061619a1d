#include "sim/field_drives.hpp"

#include <algorithm>
#include <limits>

namespace patella::sim {

FieldDrives::FieldDrives(const std::vector<FieldDriveOptions>& options)
    : torque_Nm_(
          JointVector::Zero(std::min<Eigen::Index>(static_cast<Eigen::Index>(options.size()), kMaxJoints))) {
  for (const FieldDriveOptions& one : options) {
    drives_.push_back(makeFieldDrive(one));
  }
}

void FieldDrives::watch(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  for (const auto& drive : drives_) {
    drive->watch(now_ns);
  }
}

void FieldDrives::advance(double dt_s) noexcept PATELLA_NONBLOCKING {
  for (const auto& drive : drives_) {
    drive->advance(dt_s);
  }
}

std::int64_t FieldDrives::deadline_ns() const noexcept {
  std::int64_t earliest_ns = std::numeric_limits<std::int64_t>::max();
  for (const auto& drive : drives_) {
    earliest_ns = std::min(earliest_ns, drive->deadline_ns());
  }
  return earliest_ns;
}

const JointVector& FieldDrives::torque() noexcept PATELLA_NONBLOCKING {
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    torque_Nm_[static_cast<Eigen::Index>(joint)] = drives_[joint]->torque();
  }
  return torque_Nm_;
}

std::uint64_t FieldDrives::watchdogTrips() const noexcept {
  std::uint64_t trips = 0;
  for (const auto& drive : drives_) {
    trips += drive->watchdogTrips();
  }
  return trips;
}

}  // namespace patella::sim
