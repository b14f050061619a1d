// Frames that are old, forged, bad now and then, or come back after a silence.
#include <doctest/doctest.h>

#include "tests/unit/can/decoder_fixture.hpp"

using namespace patella;
using namespace patella::can;
using namespace patella::can::test;
using safety::Fault;

TEST_CASE("a frame that was overtaken, or recorded and played again, changes nothing") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  const Frame old = f.rig.make("Encoder1", kMillisecond, {{"Position", 0.3}});
  f.decoder.accept(old);
  for (std::int64_t t = 2; t < 40; ++t) {
    f.encoders(t * kMillisecond, 0.001 * static_cast<double>(t), 0.0);
    f.decoder.finish(t * kMillisecond);
  }
  Frame replayed = old;
  replayed.monotonic_ns = 39 * kMillisecond;
  replayed.wall_ns = kEpoch + replayed.monotonic_ns;
  f.decoder.accept(replayed);
  const Reading reading = f.decoder.finish(39 * kMillisecond);
  CHECK(reading.measurement.position_rad[0] == doctest::Approx(0.039));
  CHECK(f.statistics("Encoder1").reordered == 1);
  CHECK_FALSE(reading.faults.any());
  f.encoders(40 * kMillisecond, 0.04, 0.0);
  CHECK(f.decoder.finish(40 * kMillisecond).measurement.encoder_steps == 1);
}

TEST_CASE("frames lost from a bunch that comes late are told by the stamps") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  f.decoder.finish(0);
  for (int i = 0; i < 10; ++i) {
    f.rig.make("Encoder1", 0, {});
    f.rig.make("Encoder2", 0, {});
  }
  // Taken off the bus at once, 20 ms late.
  for (std::int64_t t = 11; t < 20; ++t) {
    for (const char* name : {"Encoder1", "Encoder2"}) {
      Frame frame = f.rig.make(name, t * kMillisecond, {});
      frame.monotonic_ns = 20 * kMillisecond;
      f.decoder.accept(frame);
    }
  }
  CHECK(f.decoder.finish(20 * kMillisecond).measurement.encoder_steps == 19);
  CHECK(f.statistics("Encoder1").reordered == 0);
}

TEST_CASE("one forged frame before each genuine one is found out, though no two in a row are bad") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  int detected = 0;
  for (std::int64_t t = 1; t < 30 && detected == 0; ++t) {
    Frame genuine = f.rig.make("Encoder1", t * kMillisecond, {});
    Frame forged = genuine;  // right counter, right CRC
    f.decoder.accept(forged);
    f.decoder.accept(genuine);
    f.decoder.accept(f.rig.make("Encoder2", t * kMillisecond, {}));
    if (f.decoder.finish(t * kMillisecond).faults.has(Fault::kFrameSequence))
      detected = static_cast<int>(t);
  }
  CHECK(detected > 3);
  CHECK(detected <= 10);
}

TEST_CASE("a bad frame now and then is no fault, every fourth is") {
  for (const int period : {4, 20}) {
    CAPTURE(period);
    Fixture f;
    bool fault = false;
    for (int t = 0; t < 2000; ++t) {
      const std::int64_t now = t * kMillisecond;
      f.encoders(now, 0.0, 0.0);
      f.others(now);
      if (t % period == 0) {
        Frame corrupt = f.rig.make("DriveStatus", now, {});
        corrupt.data[0] ^= 0x01;
        f.decoder.accept(corrupt);
      }
      fault = fault || f.decoder.finish(now).faults.has(Fault::kFrameCorrupt);
    }
    CHECK(fault == (period == 4));
  }
}

TEST_CASE("a wall clock that is set by half a second makes no half second pass") {
  Fixture f;
  std::int64_t set_ns = 0;
  for (std::int64_t t = 0; t < 20; ++t) {
    set_ns = t >= 10 ? 500 * kMillisecond : 0;
    for (const char* name : {"Encoder1", "Encoder2"}) {
      Frame frame = f.rig.make(name, t * kMillisecond, {});
      frame.wall_ns += set_ns;
      f.decoder.accept(frame);
    }
    CHECK(f.decoder.finish(t * kMillisecond).measurement.encoder_steps == 1);
  }
}

TEST_CASE("enable that is held when the operator's cable is put back is no press") {
  Fixture f;
  const auto buttons = [&](std::int64_t millisecond, double enable, double reset) {
    f.decoder.accept(
        f.rig.make("Operator", millisecond * kMillisecond, {{"Enable", enable}, {"Reset", reset}}));
    return f.decoder.finish(millisecond * kMillisecond).measurement;
  };
  CHECK(buttons(0, 1, 1).operator_enable);
  CHECK_FALSE(f.decoder.finish(501 * kMillisecond).measurement.operator_enable);
  CHECK_FALSE(buttons(600, 1, 1).operator_enable);
  CHECK_FALSE(buttons(610, 1, 1).operator_reset);
  CHECK_FALSE(buttons(620, 0, 1).operator_enable);
  CHECK(buttons(630, 1, 1).operator_enable);
  CHECK_FALSE(buttons(640, 1, 0).operator_reset);
  CHECK(buttons(650, 1, 1).operator_reset);
}
