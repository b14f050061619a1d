// Which reports of the drives fit the commands, and how soon others are found.
#include "core/safety/drive_monitor.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/safety/safety_fixture.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

namespace {

// A drive of its own mind, a tick a step.
class DrivePair {
 public:
  explicit DrivePair(const DriveMonitorSettings& settings = {})
      : monitor_(2, settings, legLimits(), kTick_s) {
    report.has_drive_torque = true;
    for (EnabledReport& joint : report.drive_enabled)
      joint.bound = true;
    report.reportDriveTorque(pair(0.0, 0.0));
    reportEnabled(false);
    command.torque_Nm = pair(0.0, 0.0);
  }
  void reportTorque(Eigen::Index joint, double torque_Nm) {
    JointVector all = report.drive_torque_Nm;
    all[joint] = torque_Nm;
    report.reportDriveTorque(all);
  }
  void reportEnabled(bool enabled) {
    for (EnabledReport& joint : report.drive_enabled) {
      joint.was_enabled = enabled;
      joint.was_disabled = !enabled;
    }
  }
  /// One tick: judges the report, then takes the command.
  FaultSet step(double torque_Nm, bool enable = true) {
    const FaultSet faults = monitor_.update(report);
    command.torque_Nm = pair(torque_Nm, 0.0);
    command.enable = enable;
    monitor_.commanded(command);
    return faults;
  }
  /// Ticks until the fault, at most 200.
  int until(Fault fault, double torque_Nm, bool enable = true) {
    for (int k = 0; k < 200; ++k) {
      if (step(torque_Nm, enable).has(fault)) {
        return k;
      }
    }
    return -1;
  }
  Measurement report;
  Command command;

 private:
  DriveMonitor monitor_;
};

}  // namespace

TEST_CASE("a drive that follows late but in time is in order; one that does not is not") {
  DrivePair drive;
  drive.reportEnabled(true);
  double before = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double torque = 80.0 * std::sin(0.05 * k);  // 4 N·m a tick
    drive.reportTorque(0, before);
    CHECK_FALSE(drive.step(torque).any());
    before = torque;
  }
  drive.reportTorque(0, 0.0);
  const int stuck = drive.until(Fault::kDriveNotFollowing, 50.0);
  CHECK(stuck > 20);
  CHECK(stuck <= 42);  // response and time
}

TEST_CASE("torque without a command, and a drive that stays enabled or disabled against its command") {
  SUBCASE("pushes while disabled") {
    DrivePair drive;
    drive.reportTorque(1, 8.5);
    CHECK(drive.until(Fault::kDriveNotFollowing, 0.0, false) == 20);
  }
  SUBCASE("within the tolerance") {
    DrivePair drive;
    drive.reportTorque(1, 7.5);
    CHECK(drive.until(Fault::kDriveNotFollowing, 0.0, false) == -1);
  }
  SUBCASE("torque of a command that did not enable is none") {
    DrivePair drive;
    drive.reportTorque(0, 50.0);
    CHECK(drive.until(Fault::kDriveNotFollowing, 50.0, false) == 20);
  }
  SUBCASE("stays enabled") {
    DrivePair drive;
    drive.reportEnabled(true);
    CHECK(drive.until(Fault::kDriveNotFollowing, 0.0, false) == 20);
  }
  SUBCASE("does not enable") {
    DrivePair drive;
    CHECK(drive.until(Fault::kDriveNotFollowing, 0.0, true) == 41);  // 21 ticks of commands, and 21 bad ones
  }
  SUBCASE("not bound, not asked") {
    DrivePair drive;
    for (EnabledReport& joint : drive.report.drive_enabled)
      joint.bound = false;
    drive.report.has_drive_torque = false;
    drive.reportTorque(0, 500.0);
    CHECK(drive.until(Fault::kDriveNotFollowing, 0.0, true) == -1);
  }
  SUBCASE("switched off") {
    DrivePair drive({.enabled = false});
    drive.reportTorque(0, 500.0);
    CHECK(drive.until(Fault::kDriveNotFollowing, 0.0, true) == -1);
  }
}

TEST_CASE("torque above the limit is found within three reports, in either direction") {
  for (const double sign : {1.0, -1.0}) {
    DrivePair drive;
    drive.reportTorque(0, sign * 109.0);
    CHECK(drive.until(Fault::kDriveOverTorque, sign * 100.0) == -1);
    drive.reportTorque(0, sign * 111.0);
    CHECK(drive.until(Fault::kDriveOverTorque, sign * 100.0) == 2);
    drive.reportTorque(0, kNaN);
    CHECK(drive.step(0.0).has(Fault::kDriveOverTorque));
  }
}
