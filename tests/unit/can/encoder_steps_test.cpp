// How many sensor periods lie between two encoder samples.
#include <array>
#include <cstddef>
#include <cstdint>

#include <doctest/doctest.h>

#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/can/decoder_fixture.hpp"

using namespace patella;
using namespace patella::can;
using namespace patella::can::test;
using safety::Fault;

TEST_CASE("encoder steps count sensor periods between complete sets, whatever is lost or comes late") {
  Fixture f;
  f.encoders(0, 0.0, 0.0);
  CHECK(f.decoder.finish(0).measurement.encoder_steps == 1);
  f.encoders(1 * kMillisecond, 0.0, 0.0);
  CHECK(f.decoder.finish(1 * kMillisecond).measurement.encoder_steps == 1);
  CHECK(f.decoder.finish(2 * kMillisecond).measurement.encoder_steps == 0);
  f.encoders(2 * kMillisecond, 0.0, 0.0);
  f.encoders(3 * kMillisecond, 0.0, 0.0);
  CHECK(f.decoder.finish(3 * kMillisecond).measurement.encoder_steps == 2);

  SUBCASE("one joint's frame is lost") {
    f.decoder.accept(f.rig.make("Encoder1", 4 * kMillisecond, {}));
    f.rig.make("Encoder2", 4 * kMillisecond, {});
    CHECK(f.decoder.finish(4 * kMillisecond).measurement.encoder_steps == 0);
    f.encoders(5 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(5 * kMillisecond).measurement.encoder_steps == 2);
    CHECK(f.statistics("Encoder2").lost == 1);
    CHECK(f.statistics("Encoder1").lost == 0);
  }
  SUBCASE("the tick falls between the two encoders' frames, for a while") {
    int total = 0;
    for (std::int64_t t = 4; t < 104; ++t) {
      f.decoder.accept(f.rig.make("Encoder1", t * kMillisecond, {}));
      if (t > 4) {
        const int steps = f.decoder.finish(t * kMillisecond).measurement.encoder_steps;
        CHECK(steps == 1);
        total += steps;
      }
      f.decoder.accept(f.rig.make("Encoder2", t * kMillisecond, {}));
    }
    total += f.decoder.finish(104 * kMillisecond).measurement.encoder_steps;
    f.encoders(104 * kMillisecond, 0.0, 0.0);
    total += f.decoder.finish(105 * kMillisecond).measurement.encoder_steps;
    CHECK(total == 101);
  }
  SUBCASE("silence longer than the counter's turn shows on the clock") {
    for (int i = 0; i < 700; ++i) {
      f.rig.make("Encoder1", 0, {});
      f.rig.make("Encoder2", 0, {});
    }
    f.encoders(704 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(704 * kMillisecond).measurement.encoder_steps == 701);
    CHECK(f.statistics("Encoder1").lost == 700);
    CHECK(f.statistics("Encoder1").late == 1);
  }
  SUBCASE("a restarted encoder is refused until its timeout is over, is a fault, and then looks new") {
    for (int i = 0; i < 57; ++i)
      f.rig.make("Encoder2", 0, {});
    for (std::int64_t t = 4; t <= 8; ++t) {
      f.encoders(t * kMillisecond, 0.0, 0.0);
      const Reading reading = f.decoder.finish(t * kMillisecond);
      CHECK(reading.measurement.encoder_steps == 0);
      CHECK(reading.faults.has(Fault::kFrameSequence) == (t >= 7));
    }
    CHECK(f.statistics("Encoder2").reordered == 5);
    f.encoders(9 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(9 * kMillisecond).measurement.encoder_steps == 6);
    f.encoders(10 * kMillisecond, 0.0, 0.0);
    CHECK(f.decoder.finish(10 * kMillisecond).measurement.encoder_steps == 1);
    f.decoder.accept(f.rig.make("Encoder1", 11 * kMillisecond, {}));
    CHECK(f.decoder.finish(11 * kMillisecond).measurement.encoder_steps == 0);
  }
}

TEST_CASE("without counters the periods come from the bus stamps, and a set clock does not disturb them") {
  BusMap map = test::rigMap();
  map.protections.clear();
  Fixture f(map);
  f.encoders(0, 0.0, 0.0);
  f.decoder.finish(0);
  const std::array<std::int64_t, 4> times_us = {1100, 1900, 5050, 6000};
  const std::array<int, 4> steps = {1, 1, 3, 1};
  for (std::size_t i = 0; i < times_us.size(); ++i) {
    f.encoders(times_us[i] * 1000, 0.0, 0.0);
    CHECK(f.decoder.finish(times_us[i] * 1000).measurement.encoder_steps == steps[i]);
  }
  for (const char* name : {"Encoder1", "Encoder2"}) {
    Frame frame = f.rig.make(name, 7 * kMillisecond, {});
    frame.wall_ns += 3'600'000'000'000;
    f.decoder.accept(frame);
  }
  CHECK(f.decoder.finish(7 * kMillisecond).measurement.encoder_steps == 1);
}
