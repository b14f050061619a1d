// Drives that have to be told to enter: when frames go out, when torque may flow, and what is a fault.
#include "core/safety/drive_entry.hpp"

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::safety;

namespace {

constexpr double kTick_s = 1e-3;

/// The loop around it, a tick a call: ready, and active whenever enable gets through.
class Pair {
 public:
  explicit Pair(const std::vector<DriveEntrySettings>& drives) : entry(drives, kTick_s) {}

  /// Each joint's drive reports as told; returns what was found.
  FaultSet tick() {
    Measurement measurement;
    measurement.operator_enable = enable;
    measurement.operator_reset = reset;
    for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
      measurement.drive_enabled[joint] = {true, says_enabled[joint], !says_enabled[joint]};
    }
    const FaultSet faults = entry.before(measurement);
    let_through = measurement.operator_enable;
    left_to_monitor = measurement.drive_enabled[0].bound;
    if (faults.any()) {
      state = State::kFault;
    } else if (state == State::kReady && let_through) {
      state = State::kActive;
    } else if (state == State::kActive && !let_through) {
      state = State::kReady;
    }
    entry.after(state);
    return faults;
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i)
      tick();
  }
  /// Both have left, and the operator's enable is seen released.
  void settle() {
    says_enabled = {};
    enable = false;
    ticks(2);
  }

  DriveEntry entry;
  State state = State::kReady;
  bool enable = false;
  bool reset = false;
  std::array<bool, kMaxJoints> says_enabled{};
  bool let_through = false;
  bool left_to_monitor = false;
};

DriveEntrySettings drive(std::size_t joint) {
  DriveEntrySettings settings{.needed = true};
  settings.joints[joint] = true;
  return settings;
}

DriveEntrySettings blind(std::size_t joint) {
  DriveEntrySettings settings = drive(joint);
  settings.blind_s = 0.05;
  return settings;
}

}  // namespace

TEST_CASE("without a drive that has to enter, nothing is changed") {
  DriveEntrySettings plain;
  plain.joints = {true, true};
  Pair pair({plain});
  pair.enable = true;
  CHECK_FALSE(pair.tick().any());
  CHECK(pair.let_through);
  CHECK(pair.left_to_monitor);
  CHECK(pair.entry.frames(0) == DriveFrames::kNone);
}

TEST_CASE("enable gets through once every drive reports that it is in") {
  Pair pair({drive(0), drive(1)});
  pair.settle();
  CHECK(pair.entry.phase(0) == DrivePhase::kOut);
  pair.enable = true;
  CHECK_FALSE(pair.tick().any());
  CHECK(pair.entry.frames(0) == DriveFrames::kEnter);
  CHECK(pair.entry.frames(1) == DriveFrames::kEnter);
  CHECK_FALSE(pair.let_through);
  pair.ticks(9);
  CHECK(pair.entry.frames(0) == DriveFrames::kNone);
  pair.tick();
  CHECK(pair.entry.frames(0) == DriveFrames::kEnter);
  pair.says_enabled[0] = true;
  pair.ticks(30);
  CHECK_FALSE(pair.let_through);
  CHECK(pair.entry.phase(0) == DrivePhase::kIn);
  CHECK(pair.entry.phase(1) == DrivePhase::kEntering);
  pair.says_enabled[1] = true;
  pair.tick();
  CHECK(pair.let_through);
  CHECK(pair.state == State::kActive);
  CHECK_FALSE(pair.left_to_monitor);
  pair.ticks(100);
  CHECK(pair.let_through);
  CHECK(pair.entry.frames(0) == DriveFrames::kNone);

  SUBCASE("enable released: they leave in the same tick, until they report it") {
    pair.enable = false;
    pair.tick();
    CHECK(pair.state == State::kReady);
    CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
    CHECK(pair.entry.frames(1) == DriveFrames::kLeave);
    pair.says_enabled[0] = false;
    pair.ticks(10);
    CHECK(pair.entry.phase(0) == DrivePhase::kOut);
    CHECK(pair.entry.frames(1) == DriveFrames::kLeave);
  }
  SUBCASE("a fault of the loop: they leave in the tick that finds it") {
    pair.state = State::kFault;
    pair.tick();
    CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
  }
  SUBCASE("one leaves by itself: a fault, in that tick") {
    pair.says_enabled[1] = false;
    CHECK(pair.tick() == FaultSet{Fault::kDriveLeft});
    CHECK_FALSE(pair.let_through);
    CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
  }
  SUBCASE("and told to leave, it stays: a fault after its time") {
    pair.enable = false;
    int ticks = 0;
    while (ticks < 1000 && !pair.tick().has(Fault::kDriveNotFollowing))
      ++ticks;
    CHECK(ticks >= 499);
    CHECK(ticks <= 501);
  }
}

TEST_CASE("whichever drive is the last to be in, torque waits for it") {
  Pair pair({drive(0), drive(1)});
  pair.settle();
  pair.enable = true;
  pair.says_enabled = {false, true};
  pair.ticks(30);
  CHECK_FALSE(pair.let_through);
  CHECK(pair.entry.phase(0) == DrivePhase::kEntering);
  CHECK(pair.entry.phase(1) == DrivePhase::kIn);
}

TEST_CASE("a drive that ignores what it is told is a fault after its time, and not asked again by itself") {
  Pair pair({drive(0), drive(1)});
  pair.settle();
  pair.enable = true;
  pair.says_enabled[0] = true;
  int ticks = 1;
  while (ticks < 1000 && !pair.tick().has(Fault::kDriveNotEntered))
    ++ticks;
  CHECK(ticks == 501);
  CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
  pair.state = State::kReady;  // the operator has reset, with enable held
  pair.ticks(20);
  CHECK_FALSE(pair.let_through);
  CHECK(pair.entry.phase(1) != DrivePhase::kEntering);
}

TEST_CASE("enable that is held since before, or raised in another state than ready, enters nothing") {
  Pair pair({drive(0)});
  pair.enable = true;
  pair.ticks(50);
  CHECK(pair.entry.phase(0) == DrivePhase::kOut);
  pair.state = State::kInit;
  pair.enable = false;
  pair.ticks(2);
  pair.enable = true;
  pair.tick();
  CHECK(pair.entry.phase(0) == DrivePhase::kOut);
  CHECK(pair.entry.frames(0) == DriveFrames::kNone);
  pair.tick();
  pair.state = State::kReady;
  pair.ticks(20);
  CHECK(pair.entry.phase(0) == DrivePhase::kOut);
}

TEST_CASE("a drive that does not report is told for its time, to enter and to leave") {
  Pair pair({blind(0)});
  CHECK(pair.entry.phase(0) == DrivePhase::kLeaving);
  pair.tick();
  CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
  pair.ticks(50);
  CHECK(pair.entry.phase(0) == DrivePhase::kOut);
  pair.enable = true;
  int sent = 0;
  int ticks = 0;
  for (; ticks < 1000 && !pair.let_through; ++ticks) {
    pair.tick();
    sent += pair.entry.frames(0) == DriveFrames::kEnter ? 1 : 0;
  }
  CHECK(sent == 5);
  CHECK(ticks == 51);
}

TEST_CASE("a drive that a run before left enabled is told to leave") {
  Pair pair({drive(0)});
  pair.settle();
  pair.says_enabled[0] = true;
  pair.tick();
  CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
}

TEST_CASE("reset clears a drive's errors while it is out, and only then") {
  Pair pair({drive(0)});
  pair.settle();
  pair.reset = true;
  pair.tick();
  CHECK(pair.entry.frames(0) == DriveFrames::kClear);
  pair.tick();
  CHECK(pair.entry.frames(0) == DriveFrames::kNone);
  pair.reset = false;
  pair.enable = true;
  pair.says_enabled[0] = true;
  pair.ticks(20);
  CHECK(pair.state == State::kActive);
  pair.reset = true;
  pair.tick();
  CHECK(pair.entry.frames(0) == DriveFrames::kNone);
}

TEST_CASE("a reset is not lost to frames to leave by: they come first, and clear in the tick after") {
  // At 50 Hz they are due in every tick.
  for (const double period_s : {0.01, kTick_s}) {
    DriveEntrySettings settings = drive(0);
    settings.period_s = period_s;
    Pair pair({settings});
    pair.says_enabled[0] = true;
    pair.tick();
    CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
    pair.ticks(9);
    pair.reset = true;
    pair.tick();
    CHECK(pair.entry.frames(0) == DriveFrames::kLeave);
    pair.tick();
    CHECK(pair.entry.frames(0) == DriveFrames::kClear);
    int cleared = 0;
    int left = 0;
    for (int i = 0; i < 40; ++i) {
      pair.tick();
      cleared += pair.entry.frames(0) == DriveFrames::kClear ? 1 : 0;
      left += pair.entry.frames(0) == DriveFrames::kLeave ? 1 : 0;
    }
    CHECK(cleared == 0);
    CHECK(left >= 4);
  }
}

TEST_CASE("a drive of two joints is in when both are, and has left when one is out") {
  DriveEntrySettings both = drive(0);
  both.joints[1] = true;
  Pair pair({both});
  pair.settle();
  pair.enable = true;
  for (const bool first : {true, false}) {
    pair.says_enabled = {first, !first};
    pair.ticks(10);
    CHECK_FALSE(pair.let_through);
  }
  pair.says_enabled = {true, true};
  pair.tick();
  CHECK(pair.let_through);
  pair.says_enabled = {true, false};
  CHECK(pair.tick().has(Fault::kDriveLeft));
}

TEST_CASE("a drive of two joints is told to leave until both are out") {
  DriveEntrySettings both = drive(0);
  both.joints[1] = true;
  for (const bool first : {true, false}) {
    Pair pair({both});
    pair.says_enabled = {first, !first};
    for (int i = 0; i < 3; ++i) {
      pair.tick();
      CHECK(pair.entry.phase(0) == DrivePhase::kLeaving);
    }
    pair.says_enabled = {};
    pair.tick();
    CHECK(pair.entry.phase(0) == DrivePhase::kOut);
  }
}
