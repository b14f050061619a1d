#include "drivers/can/message_codec.hpp"

#include <cstdint>
#include <stdexcept>

#include <doctest/doctest.h>

#include "drivers/can/crc8.hpp"
#include "tests/unit/can/rig_map.hpp"

using namespace patella::can;

TEST_CASE("what one end seals the other end accepts, and judges what happened on the way") {
  const Database database = test::rigDatabase();
  const Message& message = database.message("Encoder1");
  MessageEncoder encoder(message, test::protectionOf("Encoder1"));
  MessageDecoder decoder(message, test::protectionOf("Encoder1"));
  const std::size_t out = encoder.slot("Position");
  const std::size_t in = decoder.slot("Position");

  Frame frame = encoder.blank();
  CHECK(frame.id == 0x110);
  CHECK(frame.length == 8);
  CHECK(encoder.set(frame, out, -1.25));
  encoder.seal(frame);
  CHECK(frame.data[7] == frameCrc(frame, 7));
  CHECK(decoder.matches(frame));
  CHECK(decoder.check(frame).status == FrameStatus::kUsable);
  CHECK(decoder.value(frame, in) == doctest::Approx(-1.25).epsilon(1e-12));

  CHECK(decoder.check(frame).status == FrameStatus::kRepeated);

  encoder.seal(frame);
  Frame corrupt = frame;
  corrupt.data[1] ^= 0x10;
  CHECK(decoder.check(corrupt).status == FrameStatus::kCorrupt);
  Frame cut = frame;
  cut.length = 7;
  CHECK(decoder.check(cut).status == FrameStatus::kTooShort);
  // Neither of the two moved the counter on.
  CHECK(decoder.check(frame).sequence == Sequence::kNew);

  encoder.seal(frame);
  encoder.seal(frame);
  encoder.seal(frame);
  const FrameCheck jumped = decoder.check(frame);
  CHECK(jumped.status == FrameStatus::kUsable);
  CHECK(jumped.sequence == Sequence::kJumped);
  CHECK(jumped.steps == 3);

  Frame other = frame;
  other.extended = true;
  CHECK_FALSE(decoder.matches(other));
}

TEST_CASE("a counter of eight bits runs on through its wrap") {
  const Database database = test::rigDatabase();
  MessageEncoder encoder(database.message("Emg"), test::protectionOf("Emg"));
  MessageDecoder decoder(database.message("Emg"), test::protectionOf("Emg"));
  for (int i = 0; i < 600; ++i) {
    Frame frame = encoder.blank();
    encoder.seal(frame);
    REQUIRE(frame.data[6] == (i & 0xFF));
    REQUIRE(decoder.check(frame).sequence == (i == 0 ? Sequence::kFirst : Sequence::kNew));
  }
}

TEST_CASE("CAN FD messages take the next length that the format has") {
  CHECK(fdLength(8) == 8);
  CHECK(fdLength(9) == 12);
  CHECK(fdLength(33) == 48);
  CHECK(fdLength(64) == 64);
  const Database database = parseDbc("BO_ 5 Wide: 30 N\n SG_ S : 232|8@1+ (1,0) [0|0] \"\" N\n", "fd.dbc");
  MessageEncoder encoder(database.message("Wide"));
  Frame frame = encoder.blank();
  CHECK(frame.fd);
  CHECK(frame.length == 32);
  CHECK(encoder.set(frame, encoder.slot("S"), 200.0));
  CHECK(frame.data[29] == 200);
}

TEST_CASE("set-up names what does not fit") {
  const Database database = test::rigDatabase();
  const Message& emg = database.message("Emg");
  CHECK_THROWS_WITH_AS(MessageDecoder(emg).slot("Chanel1"),
                       "message 'Emg' has no signal 'Chanel1'; there are: Channel1, Channel2, Channel3, "
                       "Channel4, Counter, Crc",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(MessageDecoder(emg, {"Emg", "Counter", "Channel1"}),
                       "CRC 'Channel1' of message 'Emg' has to be one whole byte that is always present",
                       std::invalid_argument);
  CHECK_THROWS_AS(MessageDecoder(database.message("Truth"), {"Truth", "Fu1", ""}), std::invalid_argument);
  const Database j1939 = parseDbc(
      "BO_ 5 Long: 40 N\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n"
      "BA_DEF_ BO_ \"VFrameFormat\" INT 0 15;\nBA_DEF_DEF_ \"VFrameFormat\" 3;\n",
      "j1939.dbc");
  CHECK_THROWS_WITH_AS(MessageDecoder(j1939.message("Long")),
                       "message 'Long' has 40 bytes, expected at most 8 in one frame of its format",
                       std::invalid_argument);
}
