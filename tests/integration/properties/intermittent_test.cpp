// How soon each monitor finds what comes and goes: the monitors themselves, under a share of wrong samples,
// and the table that docs/safety.md states.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <spdlog/fmt/fmt.h>

#include "core/safety/drive_monitor.hpp"
#include "core/safety/emg_monitor.hpp"
#include "core/safety/motion_monitor.hpp"
#include "core/safety/safety_limiter.hpp"
#include "drivers/can/bad_frames.hpp"
#include "firmware_app/loop/lateness.hpp"
#include "firmware_app/loop/loop.hpp"
#include "tests/unit/safety/safety_fixture.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

namespace {

constexpr int kLongest = 60000;  ///< ticks
constexpr std::array kShares = {0.02, 0.1, 0.25, 0.5, 0.95, 1.0};

/// One sample, wrong or not; true once the monitor calls it a fault.
using Monitor = std::function<bool(bool wrong)>;

struct Row {
  std::string name;
  std::string sample;  ///< what counts
  std::function<Monitor()> make;
  int burst = 1;  ///< wrong samples that come together
};

Monitor drive(Fault fault, double reported_Nm) {
  return [monitor = DriveMonitor(2, {}, legLimits(), kTick_s), fault, reported_Nm](bool wrong) mutable {
    Measurement report;
    report.has_drive_torque = true;
    report.reportDriveTorque(pair(wrong ? reported_Nm : 0.0, 0.0));
    const bool found = monitor.update(report).has(fault);
    monitor.commanded({.torque_Nm = pair(0.0, 0.0), .enable = true});
    return found;
  };
}

Monitor motion(Fault fault) {
  return [monitor = MotionMonitor(2, {}, legLimits(), {true, true}), fault](bool wrong) mutable {
    const bool unknown = fault == Fault::kModelMismatch;
    return monitor
        .update(pair(0.0, wrong && unknown ? 101.0 : 0.0), pair(wrong && !unknown ? 0.61 : 0.0, 0.0), kTick_s)
        .has(fault);
  };
}

Monitor emg(Fault fault, double wrong_mV) {
  return [monitor = EmgMonitor({}, {true, false, false, false}, 1000.0, 50.0), fault, wrong_mV,
          k = 0](bool wrong) mutable {
    const double muscle_mV = 0.28 * std::sin(12.9898 * k * k + 78.233 * k);
    ++k;
    return monitor.update({wrong ? wrong_mV : muscle_mV, 0.0, 0.0, 0.0}, 1).has(fault);
  };
}

Monitor frames() {
  return [count = can::BadFrames()](bool wrong) mutable {
    count.count(wrong, 3);
    return count.tooMany(3);
  };
}

std::vector<Row> rows() {
  const app::LoopOptions loop;
  return {
      {"`drive_not_following`", "ms", [] { return drive(Fault::kDriveNotFollowing, 60.0); }},
      {"`drive_over_torque`", "ms", [] { return drive(Fault::kDriveOverTorque, 260.0); }},
      {"`frame_corrupt`, `frame_sequence`, `encoder_implausible`, `frame_implausible`, of each message",
       "frames", [] { return frames(); }},
      {"`model_mismatch`", "ms", [] { return motion(Fault::kModelMismatch); }},
      {"`following_error`", "ms", [] { return motion(Fault::kFollowingError); }},
      {"`torque_limit`", "ms",
       [] {
         return Monitor([limiter = SafetyLimiter(2, legLimits())](bool wrong) mutable {
           return limiter.apply(pair(wrong ? 120.0 : 0.0, 0.0), pair(0.0, 0.0), pair(0.0, 0.0), kTick_s)
               .faults.has(Fault::kTorqueLimit);
         });
       }},
      {"`network_fallback`", "ms",
       [] {
         return Monitor([monitor = NetworkMonitor(2, {}, legLimits())](bool wrong) mutable {
           return !monitor.trusted(pair(wrong ? 26.0 : 0.0, 0.0), kTick_s);
         });
       }},
      {"`emg_saturated`", "ms", [] { return emg(Fault::kEmgSaturated, 1.5); }},
      {"`emg_electrode_off`, in gaps of 100 ms", "ms", [] { return emg(Fault::kEmgElectrodeOff, 0.3); }, 100},
      {"`send_failed`", "commands",
       [loop] {
         return Monitor([score = LeakyScore(loop.send_failures_tolerated)](bool wrong) mutable {
           return score.update(wrong, 1.0);
         });
       }},
      {"`overrun`, by missed periods", "periods",
       [] {
         return Monitor([lateness = app::Lateness({}), missed = 0U](bool wrong) mutable {
           if (wrong) {
             ++missed;
             return false;
           }
           return lateness.begin(std::exchange(missed, 0U));
         });
       }},
  };
}

/// Samples until the fault with that share wrong, in bursts spread evenly; -1: never.
int foundAfter(const Row& row, double share) {
  const Monitor monitor = row.make();
  double due = 0.0;
  int burst = 0;
  for (int k = 0; k < kLongest; ++k) {
    due += share;
    if (burst == 0 && due >= row.burst) {
      burst = row.burst;
      due -= row.burst;
    }
    const bool wrong = burst > 0 || share == 1.0;
    burst -= burst > 0 ? 1 : 0;
    if (monitor(wrong)) {
      return k + 1;
    }
  }
  return -1;
}

std::string tableRow(const Row& row) {
  std::string text = "| " + row.name + " | " + row.sample + " |";
  for (const double share : kShares) {
    const int found = foundAfter(row, share);
    text += found > 0 ? fmt::format(" {} |", found) : " – |";
  }
  return text;
}

std::vector<std::string> documented() {
  std::ifstream stream(checkout::source() / "docs/safety.md");
  std::vector<std::string> lines;
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("| what comes and goes |")) {
      inside = true;
    } else if (inside && !line.starts_with("|")) {
      break;
    } else if (inside && !line.starts_with("|--")) {
      lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace

TEST_CASE("the documented times to find what comes and goes are those of the monitors") {
  std::vector<std::string> measured;
  std::string table;
  for (const Row& row : rows()) {
    measured.push_back(tableRow(row));
    table += measured.back() + "\n";
  }
  INFO("the table as measured:\n" << table);
  CHECK(documented() == measured);
}

TEST_CASE(
    "a share of a tenth is found by every monitor, however it comes; half of that by none but the drives'") {
  for (const Row& row : rows()) {
    CAPTURE(row.name);
    const bool of_drives = row.name.starts_with("`drive");
    // An electrode has to stand still for a while before it counts, and a stall's worth of periods is free.
    const bool slow = row.name.starts_with("`emg_electrode_off") || row.name.starts_with("`overrun");
    CHECK(foundAfter(row, slow ? 0.25 : 0.1) > 0);
    CHECK((foundAfter(row, 0.045) > 0) == of_drives);
    CHECK((foundAfter(row, 0.015) > 0) == false);
  }
}

TEST_CASE("one good report in twenty, or in three, hides nothing that the drives do") {
  for (const double share : {0.05, 0.5, 2.0 / 3.0, 0.75, 0.95}) {
    CAPTURE(share);
    CHECK(foundAfter({"", "", [] { return drive(Fault::kDriveOverTorque, 300.0); }}, share) > 0);
    CHECK(foundAfter({"", "", [] { return drive(Fault::kDriveNotFollowing, 60.0); }}, share) > 0);
  }
  // "Enabled" against the command in 19 of 20 reports.
  DriveMonitor monitor(2, {}, legLimits(), kTick_s);
  int found = -1;
  for (int k = 0; k < 1000 && found < 0; ++k) {
    Measurement report;
    report.drive_enabled[0] = {true, k % 20 != 19, k % 20 == 19};
    found = monitor.update(report).has(Fault::kDriveNotFollowing) ? k : -1;
    monitor.commanded({.torque_Nm = pair(0.0, 0.0), .enable = false});
  }
  CHECK(found >= 20);
  CHECK(found <= 24);
}

TEST_CASE("mains hum that comes and goes by a quarter of a second is found") {
  EmgMonitor monitor({}, {true, false, false, false}, 1000.0, 50.0);
  int found = -1;
  for (int k = 0; k < 10000 && found < 0; ++k) {
    const bool hums = k % 500 < 250;
    const double signal_mV = hums ? std::sin(2.0 * std::numbers::pi * 50.0 * k * kTick_s) : 0.01 * (k % 7);
    found = monitor.update({signal_mV, 0.0, 0.0, 0.0}, 1).has(Fault::kEmgHum) ? k : -1;
  }
  CHECK(found > 200);
  CHECK(found < 1000);
}
