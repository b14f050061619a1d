// What each monitor finds implausible, how soon, and what it lets pass.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "core/bounds/bounds.hpp"
#include "core/safety/drive_monitor.hpp"
#include "core/safety/emg_monitor.hpp"
#include "core/safety/encoder_monitor.hpp"
#include "core/safety/motion_monitor.hpp"

using namespace patella;
using namespace patella::safety;

namespace {

constexpr double kTick_s = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

JointVector pair(double first, double second) {
  JointVector v(2);
  v << first, second;
  return v;
}

SafetyLimits limits() {
  SafetyLimits limits;
  for (JointLimits& joint : limits.joint) {
    joint.torque_Nm = 100.0;
  }
  return limits;
}

}  // namespace

TEST_CASE("a condition counts once it has lasted longer than the time") {
  LeakyScore three(0.003);
  CHECK_FALSE(three.update(true, kTick_s));
  CHECK_FALSE(three.update(true, kTick_s));
  CHECK_FALSE(three.update(true, kTick_s));
  CHECK(three.update(true, kTick_s));
  LeakyScore at_once(0.0);
  CHECK(at_once.update(true, kTick_s));
}

TEST_CASE(
    "a condition with breaks counts by its share of the time, and good time makes up for it by the "
    "recovery") {
  for (const double recovery : {kRecovery, kDriveRecovery}) {
    for (const double share : {0.004, 0.01, 0.04, 0.08, 0.2, 0.5, 0.9}) {
      CAPTURE(recovery);
      CAPTURE(share);
      LeakyScore score(0.02, recovery);
      const double rise = share - (1.0 - share) / recovery;
      int found = -1;
      double bad = 0.0;
      for (int k = 0; k < 20000 && found < 0; ++k) {
        bad += share;  // spread as evenly as ticks allow
        const bool is_bad = bad >= 1.0;
        bad -= is_bad ? 1.0 : 0.0;
        found = score.update(is_bad, kTick_s) ? k : -1;
      }
      if (rise <= 0.0) {
        CHECK(found == -1);
      } else {
        // One burst earlier or later than the mean says.
        CHECK(found * rise >= 19.0 - 1.0 / share * rise);
        CHECK(found * rise <= 22.0 + 1.0 / share * rise);
      }
    }
  }
}

TEST_CASE("what was bad for long is forgiven as soon as what was bad just too long") {
  const auto goodTicks = [](int bad_ticks) {
    LeakyScore score(0.02);
    for (int k = 0; k < bad_ticks; ++k) {
      score.update(true, kTick_s);
    }
    int ticks = 0;
    while (score.exceeded()) {
      score.update(false, kTick_s);
      ++ticks;
    }
    return ticks;
  };
  CHECK(goodTicks(21) == 16);
  CHECK(goodTicks(100000) == 16);
}

TEST_CASE("encoder and rate: any smooth motion is consistent; jump, drift, freeze and a wrong rate are not") {
  const auto detectedAfter = [](double jump_rad, double drift_rad_s, bool freeze, double rate_gain) {
    EncoderMonitor monitor(2, {});
    double frozen = 0.0;
    for (int k = 0; k < 3000; ++k) {
      const double t = k * kTick_s;
      const bool faulty = k >= 1000;
      double q = 0.5 * std::sin(6.0 * t);
      const double dq = 3.0 * std::cos(6.0 * t);
      if (k == 1000) {
        frozen = q;
      }
      q = faulty ? (freeze ? frozen : q + jump_rad + drift_rad_s * (t - 1.0)) : q;
      if (monitor.update(pair(0.1, q), pair(0.0, faulty ? rate_gain * dq : dq), kTick_s)) {
        return k - 1000;
      }
    }
    return -1;
  };
  CHECK(detectedAfter(0.0, 0.0, false, 1.0) == -1);
  CHECK(detectedAfter(0.0205, 0.0, false, 1.0) == 0);
  CHECK(detectedAfter(-0.0205, 0.0, false, 1.0) == 0);
  CHECK(detectedAfter(0.0195, 0.0, false, 1.0) == -1);
  CHECK(detectedAfter(0.0, 0.15, false, 1.0) == -1);  // 0.15 T < 0.02
  const int drift = detectedAfter(0.0, 1.0, false, 1.0);
  CHECK(drift > 15);
  CHECK(drift < 30);
  const int freeze = detectedAfter(0.0, 0.0, true, 1.0);
  CHECK(freeze > 0);
  CHECK(freeze < 20);
  CHECK(detectedAfter(0.0, 0.0, false, 0.0) > 0);
}

TEST_CASE("a position that does not change by a bit is found frozen in slow motion, and at rest it is none") {
  const auto foundAfter = [](double rate_rad_s, double step_rad) {
    EncoderMonitor monitor(1, {});
    JointVector q = JointVector::Zero(1);
    const JointVector dq = JointVector::Constant(1, rate_rad_s);
    for (int k = 0; k < 2000; ++k) {
      q[0] = k % 2 == 0 ? step_rad : 0.0;
      if (monitor.update(q, dq, kTick_s)) {
        return k;
      }
    }
    return -1;
  };
  CHECK(foundAfter(0.06, 0.0) > 20);
  CHECK(foundAfter(0.06, 0.0) < 150);
  CHECK(foundAfter(0.06, 1e-5) == -1);  // moves, if only a little
  CHECK(foundAfter(0.03, 0.0) == -1);
}

TEST_CASE("the encoder's monitor starts anew after what is no number, and after a silence") {
  EncoderMonitor monitor(2, {});
  CHECK_FALSE(monitor.update(pair(0.0, 0.0), pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.update(pair(kNaN, 0.0), pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.update(pair(1.0, 0.0), pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.update(pair(2.0, 0.0), pair(0.0, 0.0), 0.021));
  CHECK(monitor.update(pair(2.5, 0.0), pair(0.0, 0.0), 0.019));
}

namespace {

// A drive of its own mind, a tick a step.
class DrivePair {
 public:
  explicit DrivePair(const DriveMonitorSettings& settings = {}) : monitor_(2, settings, limits(), kTick_s) {
    report.has_drive_torque = true;
    report.has_drive_enabled = true;
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
    report.drive_was_enabled = enabled;
    report.drive_was_disabled = !enabled;
  }
  /// Follows commands `delay` ticks later, unless `stuck`.
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
    const int ticks = drive.until(Fault::kDriveNotFollowing, 0.0, true);
    CHECK(ticks > 20);
    CHECK(ticks <= 42);
  }
  SUBCASE("not bound, not asked") {
    DrivePair drive;
    drive.report.has_drive_enabled = false;
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

namespace {

constexpr std::array<bool, kMaxEmgChannels> kSecond = {false, true, false, false};

// Ticks until `fault` with signal(k) on the second electrode; at most 5000.
template <typename Signal>
int emgUntil(Fault fault, Signal&& signal, const std::array<bool, kMaxEmgChannels>& used = kSecond) {
  EmgMonitor monitor({}, used, 1000.0, 50.0);
  for (int k = 0; k < 5000; ++k) {
    if (monitor.update({0.0, signal(k), 0.0, 0.0}, 1).has(fault)) {
      return k;
    }
  }
  return -1;
}

// Noise of 0.2 mV rms or so, the same everywhere.
double muscle(int k) {
  return 0.28 * std::sin(12.9898 * k * k + 78.233 * k);
}

}  // namespace

TEST_CASE("muscle, and moderate hum, are in order") {
  const auto signal = [](int k) { return muscle(k) + 0.1 * std::sin(0.1 * std::numbers::pi * k); };
  for (const Fault fault : {Fault::kEmgElectrodeOff, Fault::kEmgSaturated, Fault::kEmgHum}) {
    CHECK(emgUntil(fault, signal) == -1);
  }
}

TEST_CASE("an electrode that stands still is off, and only one that is used") {
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int k) { return k < 1000 ? muscle(k) : 0.3; }) == 1501);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 0.0; }) == 500);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int k) { return k % 2 == 0 ? 0.0 : 0.00075; }) == 500);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int k) { return k % 2 == 0 ? 0.0 : 0.0015; }) == -1);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 0.0; }, {true, false, true, true}) == 500);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 0.0; }, {}) == -1);
}

TEST_CASE("an electrode at the end of its range is saturated") {
  CHECK(emgUntil(Fault::kEmgSaturated, [](int k) { return k < 100 ? muscle(k) : 1.5; }) == 120);
  CHECK(emgUntil(Fault::kEmgSaturated, [](int k) { return k < 100 ? muscle(k) : -1.5; }) == 120);
  CHECK(emgUntil(Fault::kEmgSaturated, [](int k) { return k % 20 == 0 ? 1.5 : muscle(k); }) == -1);
  CHECK(emgUntil(Fault::kEmgSaturated, [](int) { return 1.44; }) == -1);
}

TEST_CASE("mains hum is told from muscle by its frequency") {
  const auto hum = [](double amplitude_mV, double frequency_Hz) {
    return emgUntil(Fault::kEmgHum, [=](int k) {
      const double t = k * kTick_s;
      return muscle(k) +
             (k < 1000 ? 0.0 : amplitude_mV * std::sin(2.0 * std::numbers::pi * frequency_Hz * t));
    });
  };
  const int at_mains = hum(1.0, 50.0);
  CHECK(at_mains > 1200);
  CHECK(at_mains < 1300);
  CHECK(hum(0.25, 50.0) == -1);
  CHECK(hum(1.0, 80.0) == -1);
}

TEST_CASE("what an electrode says after a gap is no more than one sample") {
  // Muscle at its loudest, and a gap of nearly the timeout again and again: nothing but muscle.
  EmgMonitor monitor({}, kSecond, 1000.0, 50.0);
  FaultSet faults;
  for (int k = 0; k < 20000; ++k) {
    const bool after_gap = k % 300 == 299;
    faults = faults | monitor.update({0.0, after_gap ? 1.5 : muscle(k), 0.0, 0.0}, after_gap ? 49 : 1);
  }
  CHECK_FALSE(faults.any());
}

TEST_CASE("lost frames hide neither hum nor an electrode that is off or saturated") {
  const auto foundAfter = [](Fault fault, auto&& signal) {
    EmgMonitor monitor({}, kSecond, 1000.0, 50.0);
    std::mt19937 random(7);
    int steps = 0;
    for (int k = 0; k < 2000; ++k) {
      ++steps;
      if (random() % 4 != 0) {  // three in four are lost
        continue;
      }
      if (monitor.update({0.0, signal(k * kTick_s), 0.0, 0.0}, steps).has(fault)) {
        return k;
      }
      steps = 0;
    }
    return -1;
  };
  const auto within = [](int found, int longest) { return found > 0 && found <= longest; };
  CHECK(within(
      foundAfter(Fault::kEmgHum, [](double t) { return std::sin(2.0 * std::numbers::pi * 50.0 * t); }), 600));
  CHECK(within(foundAfter(Fault::kEmgElectrodeOff, [](double) { return 0.1; }), 700));
  CHECK(within(foundAfter(Fault::kEmgSaturated, [](double) { return 1.5; }), 60));
}

TEST_CASE(
    "an electrode without a number is a fault for as long as it is so, and one that nobody uses is none") {
  EmgMonitor monitor({}, kSecond, 1000.0, 50.0);
  CHECK_FALSE(monitor.update({kNaN, 0.1, kNaN, kNaN}, 1).any());
  CHECK(monitor.update({0.0, kNaN, 0.0, 0.0}, 1) == FaultSet{Fault::kNotFinite});
  CHECK_FALSE(monitor.update({0.0, 0.2, 0.0, 0.0}, 1).any());
}

TEST_CASE("torque that nothing explains, and distance from the reference, count after their times") {
  const std::array<bool, kMaxJoints> stiff = {true, false};
  MotionMonitor monitor(2, {}, limits(), stiff);
  const auto until = [&](Fault fault, const JointVector& unknown_Nm, const JointVector& error_rad) {
    monitor.reset();
    for (int k = 0; k < 500; ++k) {
      if (monitor.update(unknown_Nm, error_rad, kTick_s).has(fault)) {
        return k;
      }
    }
    return -1;
  };
  CHECK(until(Fault::kModelMismatch, pair(0.0, -101.0), pair(0.0, 0.0)) == 50);
  CHECK(until(Fault::kModelMismatch, pair(99.0, 0.0), pair(0.0, 0.0)) == -1);
  CHECK(until(Fault::kModelMismatch, pair(kNaN, 0.0), pair(0.0, 0.0)) == 50);
  CHECK(until(Fault::kFollowingError, pair(0.0, 0.0), pair(-0.61, 0.0)) == 200);
  CHECK(until(Fault::kFollowingError, pair(0.0, 0.0), pair(0.59, 0.0)) == -1);
  CHECK(until(Fault::kFollowingError, pair(0.0, 0.0), pair(0.0, 3.0)) == -1);  // goes where the patient goes
  MotionMonitor strict(2, {.unknown_torque_Nm = {10.0, 10.0}}, limits(), stiff);
  bool found = false;
  for (int k = 0; k < 60; ++k) {
    found = found || strict.update(pair(11.0, 0.0), pair(0.0, 0.0), kTick_s).has(Fault::kModelMismatch);
  }
  CHECK(found);
}

TEST_CASE("a network that contradicts the observer is not listened to until it is reset") {
  NetworkMonitor monitor(2, {}, limits());
  for (int k = 0; k < 100; ++k) {
    CHECK(monitor.trusted(pair(24.0, -24.0), kTick_s));
  }
  for (int k = 0; k < 20; ++k) {
    CHECK(monitor.trusted(pair(0.0, -26.0), kTick_s));
  }
  CHECK_FALSE(monitor.trusted(pair(0.0, -26.0), kTick_s));
  CHECK_FALSE(monitor.trusted(pair(0.0, 0.0), kTick_s));
  monitor.reset();
  CHECK(monitor.trusted(pair(0.0, 0.0), kTick_s));
  CHECK_FALSE(monitor.trusted(pair(0.0, kNaN), kTick_s));
  CHECK_FALSE(monitor.trusted(pair(0.0, 0.0), kTick_s));
}

double above(const Bound& bound) {
  return 1.01 * bound.rehearsal_maximum;
}

TEST_CASE("no monitor can be set so that it does not watch") {
  const auto refused = [](auto change) {
    MonitorSettings settings;
    change(settings);
    CHECK_THROWS_AS(requireSound(settings), std::invalid_argument);
  };
  CHECK_NOTHROW(requireSound({}));
  refused([](auto& s) { s.encoder.inconsistency_rad = above(boundOf("safety.encoder.inconsistency_rad")); });
  refused([](auto& s) { s.encoder.inconsistency_rad = kNaN; });
  refused([](auto& s) { s.encoder.frozen_rad = above(boundOf("safety.encoder.frozen_rad")); });
  refused(
      [](auto& s) { s.encoder.consistency_time_s = above(boundOf("safety.encoder.consistency_time_s")); });
  refused([](auto& s) { s.motion.unknown_torque_Nm[1] = above(boundOf("safety.motion.unknown_torque_Nm")); });
  refused([](auto& s) { s.motion.unknown_time_s = above(boundOf("safety.motion.unknown_time_s")); });
  refused([](auto& s) { s.motion.following_rad[0] = above(boundOf("safety.motion.following_rad")); });
  refused([](auto& s) { s.motion.following_time_s = above(boundOf("safety.motion.following_time_s")); });
  refused([](auto& s) { s.drive.follow_tolerance = above(boundOf("safety.drive.follow_tolerance")); });
  refused([](auto& s) { s.drive.response_s = above(boundOf("safety.drive.response_s")); });
  refused([](auto& s) { s.drive.follow_time_s = above(boundOf("safety.drive.follow_time_s")); });
  refused([](auto& s) { s.drive.over_tolerance = above(boundOf("safety.drive.over_tolerance")); });
  refused([](auto& s) { s.drive.over_time_s = above(boundOf("safety.drive.over_time_s")); });
  refused([](auto& s) { s.emg.flat_mV = -1.0; });
  refused([](auto& s) { s.emg.flat_time_s = above(boundOf("safety.emg.flat_time_s")); });
  refused([](auto& s) { s.emg.saturation_mV = above(boundOf("safety.emg.saturation_mV")); });
  refused([](auto& s) { s.emg.saturation_time_s = above(boundOf("safety.emg.saturation_time_s")); });
  refused([](auto& s) { s.emg.hum_mV = above(boundOf("safety.emg.hum_mV")); });
  refused([](auto& s) { s.emg.hum_time_s = above(boundOf("safety.emg.hum_time_s")); });
  refused([](auto& s) { s.network.disagreement_Nm[0] = above(boundOf("safety.network.disagreement_Nm")); });
  refused(
      [](auto& s) { s.network.disagreement_time_s = above(boundOf("safety.network.disagreement_time_s")); });
}
