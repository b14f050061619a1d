// Effect of each kind of the fault script on the rig's frames.
#include <cmath>
#include <set>

#include <doctest/doctest.h>

#include "drivers/can/error_monitor.hpp"
#include "drivers/can/message_codec.hpp"
#include "sim/loop_faults.hpp"
#include "tests/unit/sim/rig_fixture.hpp"

using namespace patella;
using namespace patella::sim;

namespace {

constexpr std::uint32_t kEncoder1 = 272;
constexpr std::uint32_t kEmg = 304;

// A rig on its script, a sample a step.
class Disturbed {
 public:
  /// The event begins at 3 ms; what is more, when it says.
  explicit Disturbed(FaultEvent event, const std::vector<FaultEvent>& more = {})
      : rig_(options(event, more), rigDatabase()) {}

  /// Frames of the sample at `millisecond`; call in order.
  std::vector<can::Frame> at(int millisecond) {
    rig_.advance(millisecond * kMillisecond_ns);
    return drain(rig_);
  }
  std::vector<can::Frame> at(int millisecond, std::uint32_t id) {
    std::vector<can::Frame> frames = at(millisecond);
    std::erase_if(frames, [id](const can::Frame& frame) { return frame.id != id || frame.error; });
    return frames;
  }
  Rig& rig() { return rig_; }

 private:
  static RigOptions options(FaultEvent event, const std::vector<FaultEvent>& more) {
    RigOptions options = paperRig();
    event.time_s = 0.003;
    options.faults = more;
    options.faults.insert(options.faults.begin(), event);
    return options;
  }
  Rig rig_;
};

FaultEvent fault(FaultKind kind, int channel = FaultEvent::kAll) {
  FaultEvent event;
  event.kind = kind;
  event.channel = channel;
  event.duration_s = 0.003;
  return event;
}

double position(const can::Frame& frame) {
  can::MessageDecoder decoder(rigDatabase().message("Encoder1"), {"Encoder1", "Counter", "Crc"});
  return decoder.value(frame, decoder.slot("Position"));
}

// Usable, in order of the counter, as a receiver sees it.
class Judge {
 public:
  can::FrameCheck check(const can::Frame& frame) { return decoder_.check(frame); }

 private:
  can::MessageDecoder decoder_{rigDatabase().message("Encoder1"), {"Encoder1", "Counter", "Crc"}};
};

constexpr int kFirst = static_cast<int>(FrameChannel::kEncoder1);

}  // namespace

TEST_CASE("lost frames are missing while the fault lasts, and no others") {
  Disturbed rig(fault(FaultKind::kLostFrames, kFirst));
  for (int t = 0; t < 9; ++t) {
    const auto frames = rig.at(t);
    const auto lost =
        std::none_of(frames.begin(), frames.end(), [](const auto& f) { return f.id == kEncoder1; });
    CHECK(lost == (t >= 3 && t < 6));
    CHECK(frames.size() >= (lost ? 4U : 5U));
  }
  CHECK(rig.rig().faults().firstEffects_s().at(0) == doctest::Approx(0.003));
}

TEST_CASE("delayed frames come later, with their old counter") {
  FaultEvent event = fault(FaultKind::kDelayedFrames, kFirst);
  event.delay_s = 0.002;
  Disturbed rig(event);
  std::vector<std::size_t> counts;
  for (int t = 0; t < 9; ++t) {
    counts.push_back(rig.at(t, kEncoder1).size());
  }
  CHECK(counts == std::vector<std::size_t>{1, 1, 1, 0, 0, 1, 2, 2, 1});
}

TEST_CASE("duplicated and reordered frames betray themselves by the counter") {
  Judge judge;
  Disturbed twice(fault(FaultKind::kDuplicatedFrames, kFirst));
  for (int t = 0; t < 6; ++t) {
    const auto frames = twice.at(t, kEncoder1);
    REQUIRE(frames.size() == (t < 3 ? 1 : 2));
    CHECK(judge.check(frames[0]).status == can::FrameStatus::kUsable);
    if (frames.size() == 2) {
      CHECK(judge.check(frames[1]).status == can::FrameStatus::kRepeated);
    }
  }
  Disturbed swapped(fault(FaultKind::kReorderedFrames, kFirst));
  std::vector<unsigned> counters;
  for (int t = 0; t < 7; ++t) {
    for (const can::Frame& frame : swapped.at(t, kEncoder1)) {
      counters.push_back(frame.data[6]);
    }
  }
  CHECK(counters == std::vector<unsigned>{0, 1, 2, 4, 3, 6, 5});
}

TEST_CASE("flipped bits fail by the CRC, as many as asked for") {
  for (const int bits : {1, 2, 7, 64}) {
    FaultEvent event = fault(FaultKind::kFlippedBits, kFirst);
    event.bits = bits;
    Disturbed clean(fault(FaultKind::kLostFrames, static_cast<int>(FrameChannel::kTruth)));
    Disturbed flipped(event);
    for (int t = 0; t < 6; ++t) {
      const auto right = clean.at(t, kEncoder1).at(0);
      const auto wrong = flipped.at(t, kEncoder1).at(0);
      int different = 0;
      for (std::size_t i = 0; i < 8; ++i) {
        different += std::popcount(static_cast<unsigned>(right.data[i] ^ wrong.data[i]));
      }
      CHECK(different == (t < 3 ? 0 : bits));
      Judge judge;
      if (bits < 3) {
        CHECK((judge.check(wrong).status == can::FrameStatus::kCorrupt) == (t >= 3));
      }
    }
  }
}

TEST_CASE("forged frames are as right as they are told to be") {
  for (const bool crc : {false, true}) {
    for (const bool counter : {false, true}) {
      CAPTURE(crc);
      CAPTURE(counter);
      FaultEvent event = fault(FaultKind::kForgedFrames, kFirst);
      event.value = 1.25;
      event.crc_correct = crc;
      event.counter_correct = counter;
      Disturbed rig(event);
      Judge judge;
      for (int t = 0; t < 3; ++t) {
        judge.check(rig.at(t, kEncoder1).at(0));
      }
      const auto frames = rig.at(3, kEncoder1);
      REQUIRE(frames.size() == 2);
      judge.check(frames[0]);
      CHECK(position(frames[1]) == doctest::Approx(1.25));
      const can::FrameStatus expected = !crc       ? can::FrameStatus::kCorrupt
                                        : !counter ? can::FrameStatus::kRepeated
                                                   : can::FrameStatus::kUsable;
      CHECK(judge.check(frames[1]).status == expected);
    }
  }
}

TEST_CASE("an encoder jumps, freezes, drifts and wraps") {
  const auto positions = [](FaultEvent event) {
    Disturbed rig(event);
    Disturbed clean(fault(FaultKind::kLostFrames, static_cast<int>(FrameChannel::kTruth)));
    std::vector<double> difference;
    for (int t = 0; t < 8; ++t) {
      difference.push_back(position(rig.at(t, kEncoder1).at(0)) - position(clean.at(t, kEncoder1).at(0)));
    }
    return difference;
  };
  FaultEvent jump = fault(FaultKind::kEncoderJump, 0);
  jump.value = 0.2;
  CHECK(positions(jump)[2] == 0.0);
  CHECK(positions(jump)[4] == doctest::Approx(0.2).epsilon(1e-4));
  CHECK(positions(jump)[6] == 0.0);
  FaultEvent drift = fault(FaultKind::kEncoderDrift, 0);
  drift.value = 10.0;
  CHECK(positions(drift)[5] == doctest::Approx(0.02).epsilon(1e-3));
  FaultEvent wrap = fault(FaultKind::kEncoderWrap, 0);
  wrap.value = 6.283;
  CHECK(positions(wrap)[4] == doctest::Approx(6.283).epsilon(1e-4));  // from −π/2

  Disturbed frozen(fault(FaultKind::kEncoderFreeze, 0));
  std::set<double> seen;
  for (int t = 0; t < 6; ++t) {
    const double q = position(frozen.at(t, kEncoder1).at(0));
    if (t >= 3) {
      seen.insert(q);
    }
  }
  CHECK(seen.size() == 1);
}

TEST_CASE("an electrode is saturated, off, or hums") {
  const auto channel2 = [](FaultEvent event, int millisecond) {
    Disturbed rig(event);
    can::MessageDecoder decoder(rigDatabase().message("Emg"), {});
    double value = 0.0;
    for (int t = 0; t <= millisecond; ++t) {
      value = decoder.value(rig.at(t, kEmg).at(0), decoder.slot("Channel2"));
    }
    return value;
  };
  FaultEvent saturated = fault(FaultKind::kEmgSaturation, 1);
  saturated.value = 1.5;
  CHECK(channel2(saturated, 4) == doctest::Approx(1.5));
  CHECK(channel2(fault(FaultKind::kEmgDisconnection, 1), 4) == 0.0);
  FaultEvent hum = fault(FaultKind::kEmgHum, 1);
  hum.value = 1.0;
  hum.duration_s = 1.0;
  const double without = channel2(fault(FaultKind::kLostFrames, static_cast<int>(FrameChannel::kTruth)), 5);
  CHECK(channel2(hum, 5) - without ==
        doctest::Approx(std::sin(2.0 * 3.14159265 * 50.0 * 0.005)).epsilon(1e-2));
}

TEST_CASE("a drive gives less, or more, than it was told, and nothing while it is off") {
  for (const bool over : {false, true}) {
    FaultEvent event = fault(over ? FaultKind::kDriveOverTorque : FaultKind::kDriveNotFollowing, 1);
    event.value = over ? 7.0 : 0.5;
    event.duration_s = 1.0;
    Disturbed rig(event);
    CommandPen pen;
    rig.at(0);
    rig.at(2);
    rig.rig().accept(pen.write(2.0, 4.0));
    CHECK(rig.rig().drive().torque()[1] == doctest::Approx(4.0));
    rig.at(4);
    CHECK(rig.rig().drive().torque()[0] == doctest::Approx(2.0));
    CHECK(rig.rig().drive().torque()[1] == doctest::Approx(over ? 11.0 : 2.0));
    rig.rig().accept(pen.write(2.0, 4.0, false));
    CHECK(rig.rig().drive().torque().isZero(0.0));
  }
}

TEST_CASE("bus-off and an interface that is down silence both directions") {
  for (const FaultKind kind : {FaultKind::kBusOff, FaultKind::kInterfaceDown}) {
    Disturbed rig(fault(kind));
    CommandPen pen;
    rig.at(0);
    rig.at(2);
    const auto during = rig.at(3);
    CHECK((rig.rig().interfacesDown() != 0) == (kind == FaultKind::kInterfaceDown));
    REQUIRE(during.size() == (kind == FaultKind::kBusOff ? 1 : 0));
    if (kind == FaultKind::kBusOff) {
      CHECK(during[0].error);
      CHECK(during[0].id == can::kErrorBusOff);
    }
    rig.rig().accept(pen.write(1.0, 1.0));
    CHECK(rig.rig().drive().torque().isZero(0.0));
    rig.at(5);
    const auto after = rig.at(6);
    CHECK(after.size() >= 5);
    CHECK(rig.rig().interfacesDown() == 0);
  }
}

TEST_CASE("what was held back does not come over a bus that is off") {
  FaultEvent delayed = fault(FaultKind::kDelayedFrames);
  delayed.time_s = 0.0;
  delayed.delay_s = 0.004;
  delayed.duration_s = 0.003;
  Disturbed rig(fault(FaultKind::kBusOff), {delayed});
  rig.at(2);
  const auto off = rig.at(5);
  REQUIRE(off.size() == 1);
  CHECK(off[0].error);
}

TEST_CASE("a stalled rig makes up for it late; a restarted one begins its counters anew") {
  Disturbed stalled(fault(FaultKind::kRigStall));
  std::vector<std::size_t> counts;
  for (int t = 0; t < 8; ++t) {
    counts.push_back(stalled.at(t, kEncoder1).size());
  }
  CHECK(counts == std::vector<std::size_t>{1, 1, 1, 0, 0, 0, 4, 1});

  // A delay takes as long for what a stalled rig sends.
  FaultEvent delay = fault(FaultKind::kDelayedFrames, kFirst);
  delay.time_s = 0.003;
  delay.delay_s = 0.002;
  Disturbed both(fault(FaultKind::kRigStall), {delay});
  counts.clear();
  for (int t = 0; t < 9; ++t) {
    counts.push_back(both.at(t, kEncoder1).size());
  }
  CHECK(counts == std::vector<std::size_t>{1, 1, 1, 0, 0, 0, 1, 1, 4});

  Disturbed restarted(fault(FaultKind::kPeerRestart));
  CommandPen pen;
  restarted.at(0);
  restarted.at(2);
  restarted.rig().accept(pen.write(1.0, 1.0));
  CHECK(restarted.at(3, kEncoder1).empty());
  CHECK(restarted.rig().drive().torque().isZero(0.0));
  restarted.at(5);
  CHECK(restarted.at(6, kEncoder1).at(0).data[6] == 0);
}

TEST_CASE("the loop's clock stalls and is set, its emergency stop is pressed and bounces") {
  const auto script = [](FaultKind kind, double value) {
    FaultEvent event = fault(kind);
    event.time_s = 0.010;
    event.duration_s = 0.020;
    event.value = value;
    return std::vector<FaultEvent>{event};
  };
  VirtualClock time(7'000'000'000);
  time.sleepUntil(5 * kMillisecond_ns);
  const std::int64_t epoch_ns = time.now();
  DisturbedClock stalled(time, script(FaultKind::kLoopStall, 0.0));
  stalled.sleepUntil(epoch_ns);
  stalled.sleepUntil(epoch_ns + 9 * kMillisecond_ns);
  CHECK(time.now() == epoch_ns + 9 * kMillisecond_ns);
  stalled.sleepUntil(epoch_ns + 10 * kMillisecond_ns);
  CHECK(time.now() == epoch_ns + 30 * kMillisecond_ns);

  VirtualClock second(7'000'000'000);
  DisturbedClock stepped(second, script(FaultKind::kClockStep, -2.0));
  gpio::SimulatedPins pins;
  DisturbedPins pressed(pins, stepped, script(FaultKind::kEmergencyStop, 0.0));
  DisturbedPins bounced(pins, stepped, script(FaultKind::kGpioBounce, 0.002));
  int presses = 0;
  for (int t = 0; t < 40; ++t) {
    stepped.sleepUntil(t * kMillisecond_ns);
    const bool during = t >= 10 && t < 30;
    CHECK(stepped.wallNow() - stepped.now() == (during ? 5'000'000'000 : 7'000'000'000));
    // Let go of since the last look is pressed, too, as the kernel keeps edges.
    CHECK(pressed.emergencyStop() == (during || t == 30));
    presses += bounced.emergencyStop() ? 1 : 0;
  }
  CHECK(presses >= 20);
  CHECK(presses <= 21);
}
