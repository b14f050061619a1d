#include "drivers/can/signal_codec.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <doctest/doctest.h>

using namespace patella::can;

namespace {

Signal makeSignal(int start, int length, ByteOrder order, bool is_signed) {
  Signal signal;
  signal.name = "S";
  signal.start_bit = start;
  signal.length = length;
  signal.byte_order = order;
  signal.is_signed = is_signed;
  return signal;
}

Message makeMessage(int length, std::vector<Signal> signals) {
  Message message;
  message.id = 0x123;
  message.name = "M";
  message.length = length;
  message.signals = std::move(signals);
  return message;
}

Frame makeFrame(std::uint8_t length, std::uint8_t fill = 0) {
  Frame frame;
  frame.id = 0x123;
  frame.length = length;
  frame.data.fill(fill);
  return frame;
}

/// The bits of a signal from its most significant one on, walked one at a time as the format's text defines
/// it.
std::uint64_t readBitwise(const Frame& frame, const Signal& signal) {
  std::uint64_t value = 0;
  int bit = signal.start_bit;
  for (int i = 0; i < signal.length; ++i) {
    const std::uint64_t one = (frame.data[static_cast<std::size_t>(bit / 8)] >> (bit % 8)) & 1U;
    if (signal.byte_order == ByteOrder::kIntel) {
      value |= one << i;
      ++bit;
    } else {
      value = (value << 1U) | one;
      bit = bit % 8 == 0 ? bit + 15 : bit - 1;
    }
  }
  return value;
}

int bytesNeeded(const Signal& signal) {
  if (signal.byte_order == ByteOrder::kIntel)
    return (signal.start_bit + signal.length + 7) / 8;
  const int first = signal.start_bit / 8 * 8 + 7 - signal.start_bit % 8;
  return (first + signal.length + 7) / 8;
}

}  // namespace

TEST_CASE("every start, length and byte order reads and writes the bits that the format defines") {
  std::mt19937_64 random(7);
  int tried = 0;
  for (const ByteOrder order : {ByteOrder::kIntel, ByteOrder::kMotorola}) {
    for (int start = 0; start < 8 * 11; ++start) {
      for (int length = 1; length <= 64; ++length) {
        const Signal signal = makeSignal(start, length, order, false);
        const int needed = bytesNeeded(signal);
        const CompiledSignal codec(makeMessage(needed, {signal}), signal);
        Frame frame = makeFrame(static_cast<std::uint8_t>(needed));
        for (std::uint8_t& byte : frame.data)
          byte = static_cast<std::uint8_t>(random());
        REQUIRE(codec.rawBits(frame) == readBitwise(frame, signal));

        const std::uint64_t value = random() & (~std::uint64_t{0} >> (64 - length));
        Frame written = frame;
        REQUIRE(codec.setRawBits(written, value));
        REQUIRE(readBitwise(written, signal) == value);
        // Put back what was there: if any other bit was touched, the frames now differ.
        REQUIRE(codec.setRawBits(written, readBitwise(frame, signal)));
        REQUIRE(written.data == frame.data);

        Frame too_short = frame;
        too_short.length = static_cast<std::uint8_t>(needed - 1);
        REQUIRE(codec.presence(too_short) == Presence::kTooShort);
        REQUIRE(std::isnan(codec.decode(too_short)));
        REQUIRE_FALSE(codec.setRawBits(too_short, value));
        REQUIRE_FALSE(codec.encode(too_short, 1.0));
        REQUIRE(too_short.data == frame.data);
        ++tried;
      }
    }
  }
  CHECK(tried == 2 * 88 * 64);
}

TEST_CASE("the last bits of a CAN FD frame are reached") {
  const Signal intel = makeSignal(448, 64, ByteOrder::kIntel, false);
  const Signal motorola = makeSignal(8 * 56 + 7, 64, ByteOrder::kMotorola, false);
  Frame frame = makeFrame(64);
  for (std::uint8_t i = 0; i < 8; ++i)
    frame.data[56U + i] = static_cast<std::uint8_t>(i + 1);
  CHECK(CompiledSignal(makeMessage(64, {intel}), intel).rawBits(frame) == 0x0807060504030201U);
  CHECK(CompiledSignal(makeMessage(64, {motorola}), motorola).rawBits(frame) == 0x0102030405060708U);
}

TEST_CASE("signed values, factor and offset") {
  Signal signal = makeSignal(0, 12, ByteOrder::kMotorola, true);
  signal.factor = 0.01;
  signal.offset = 250;
  const CompiledSignal codec(makeMessage(8, {signal}), signal);
  // Temperature of the well-known MotoHawk example message, in a frame c0 06 e0.
  Frame frame = makeFrame(8);
  frame.data = {0xC0, 0x06, 0xE0};
  CHECK(codec.decode(frame) == doctest::Approx(250.55));
  CHECK(codec.rawInteger(frame) == 55);

  CHECK(codec.encode(frame, 249.9));
  CHECK(codec.rawInteger(frame) == -10);
  CHECK(codec.decode(frame) == doctest::Approx(249.9));
  CHECK(frame.data[0] == 0xC1);
}

TEST_CASE("values beyond the bits saturate and say so") {
  for (const ByteOrder order : {ByteOrder::kIntel, ByteOrder::kMotorola}) {
    Signal signal = makeSignal(7, 12, order, true);
    signal.factor = 0.5;
    const CompiledSignal codec(makeMessage(8, {signal}), signal);
    Frame frame = makeFrame(8, 0x5A);
    CHECK(codec.encode(frame, 1023.5));
    CHECK_FALSE(codec.encode(frame, 1024.0));
    CHECK(codec.decode(frame) == 1023.5);
    CHECK_FALSE(codec.encode(frame, -1e300));
    CHECK(codec.decode(frame) == -1024.0);
    CHECK_FALSE(codec.encode(frame, std::numeric_limits<double>::infinity()));
    CHECK(codec.decode(frame) == 1023.5);
    const Frame before = frame;
    CHECK_FALSE(codec.encode(frame, std::numeric_limits<double>::quiet_NaN()));
    CHECK(frame.data == before.data);
  }
  Signal whole = makeSignal(0, 64, ByteOrder::kIntel, false);
  const CompiledSignal unsigned64(makeMessage(8, {whole}), whole);
  Frame frame = makeFrame(8);
  CHECK_FALSE(unsigned64.encode(frame, 1e30));
  CHECK(unsigned64.rawBits(frame) == ~std::uint64_t{0});
  CHECK_FALSE(unsigned64.encode(frame, -1.0));
  CHECK(unsigned64.rawBits(frame) == 0);
  whole.is_signed = true;
  const CompiledSignal signed64(makeMessage(8, {whole}), whole);
  CHECK_FALSE(signed64.encode(frame, -1e30));
  CHECK(signed64.rawInteger(frame) == std::numeric_limits<std::int64_t>::min());
  CHECK_FALSE(signed64.encode(frame, 1e30));
  CHECK(signed64.rawInteger(frame) == std::numeric_limits<std::int64_t>::max());
}

TEST_CASE("a negative factor turns the range around without losing a value") {
  Signal signal = makeSignal(0, 8, ByteOrder::kIntel, true);
  signal.factor = -2.0;
  const CompiledSignal codec(makeMessage(1, {signal}), signal);
  Frame frame = makeFrame(1);
  for (int raw = -128; raw <= 127; ++raw) {
    REQUIRE(codec.encode(frame, -2.0 * raw));
    REQUIRE(codec.rawInteger(frame) == raw);
    REQUIRE(codec.decode(frame) == -2.0 * raw);
  }
}

TEST_CASE("floats pass bit for bit, saturate at their largest value and carry NaN") {
  Signal single = makeSignal(32, 32, ByteOrder::kIntel, true);
  single.type = ValueType::kFloat32;
  Signal whole = makeSignal(7, 64, ByteOrder::kMotorola, true);
  whole.type = ValueType::kFloat64;
  const CompiledSignal float32(makeMessage(8, {single}), single);
  const CompiledSignal float64(makeMessage(8, {whole}), whole);
  Frame frame = makeFrame(8);
  CHECK(float32.encode(frame, -1.25));
  CHECK(float32.rawBits(frame) == std::bit_cast<std::uint32_t>(-1.25F));
  CHECK(float32.decode(frame) == -1.25);
  CHECK_FALSE(float32.encode(frame, 1e300));
  CHECK(float32.decode(frame) == static_cast<double>(std::numeric_limits<float>::max()));
  CHECK(float32.encode(frame, std::numeric_limits<double>::quiet_NaN()));
  CHECK(std::isnan(float32.decode(frame)));
  CHECK(float32.presence(frame) == Presence::kPresent);
  CHECK(float64.encode(frame, 0.1));
  CHECK(float64.decode(frame) == 0.1);
  CHECK(frame.data[0] == 0x3F);
}

TEST_CASE("the declared range counts the values at its ends, whatever rounding the factor brings") {
  Signal position = makeSignal(0, 24, ByteOrder::kIntel, true);
  position.factor = 1e-6;
  position.minimum = -8.388608;
  position.maximum = 8.388607;
  const CompiledSignal codec(makeMessage(8, {position}), position);
  Frame frame = makeFrame(8);
  codec.setRawBits(frame, 0x7FFFFF);
  CHECK(codec.inRange(codec.decode(frame)));
  codec.setRawBits(frame, 0x800000);
  CHECK(codec.inRange(codec.decode(frame)));
  CHECK_FALSE(codec.inRange(8.388608));
  CHECK_FALSE(codec.inRange(std::numeric_limits<double>::quiet_NaN()));

  position.minimum = position.maximum = 0.0;
  const CompiledSignal undeclared(makeMessage(8, {position}), position);
  CHECK(undeclared.inRange(1e12));
  CHECK_FALSE(undeclared.inRange(std::numeric_limits<double>::infinity()));
}

TEST_CASE("a multiplexed signal is absent unless every multiplexor above it selects it") {
  const Database database = parseDbc(
      "BU_: N\n"
      "BO_ 1 Mux: 8 N\n"
      " SG_ Outer M : 0|4@1+ (1,0) [0|0] \"\" N\n"
      " SG_ Inner m3M : 4|4@1+ (1,0) [0|0] \"\" N\n"
      " SG_ Deep m2 : 8|8@1+ (1,0) [0|0] \"\" N\n"
      " SG_ Flat m5 : 8|8@1- (1,0) [0|0] \"\" N\n"
      "SG_MUL_VAL_ 1 Inner Outer 3-3;\n"
      "SG_MUL_VAL_ 1 Deep Inner 2-2, 6-8;\n",
      "mux.dbc");
  const Message& message = database.message("Mux");
  const CompiledSignal deep(message, *message.find("Deep"));
  const CompiledSignal flat(message, *message.find("Flat"));
  Frame frame = makeFrame(8);
  frame.data[1] = 200;
  for (unsigned outer = 0; outer < 16; ++outer) {
    for (unsigned inner = 0; inner < 16; ++inner) {
      frame.data[0] = static_cast<std::uint8_t>(outer | inner << 4U);
      const bool has_deep = outer == 3 && (inner == 2 || (inner >= 6 && inner <= 8));
      REQUIRE(deep.presence(frame) == (has_deep ? Presence::kPresent : Presence::kNotSelected));
      REQUIRE(std::isnan(deep.decode(frame)) == !has_deep);
      REQUIRE(flat.presence(frame) == (outer == 5 ? Presence::kPresent : Presence::kNotSelected));
    }
  }
  frame.data[0] = 0x63;
  CHECK(deep.decode(frame) == 200.0);
  CHECK_FALSE(flat.encode(frame, 1.0));
  CHECK(frame.data[1] == 200);
}

TEST_CASE("a signal that one frame cannot carry is refused by name") {
  const auto why = [](const Message& message) {
    try {
      CompiledSignal codec(message, message.signals.front());
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(why(makeMessage(16, {makeSignal(0, 65, ByteOrder::kIntel, false)})) ==
        "signal 'S' of message 'M' has 65 bits, expected 1 to 64");
  CHECK(why(makeMessage(100, {makeSignal(0, 8, ByteOrder::kIntel, false)})).find("100 bytes") !=
        std::string::npos);
  Signal zero = makeSignal(0, 8, ByteOrder::kIntel, false);
  zero.factor = 0.0;
  CHECK(why(makeMessage(8, {zero})).find("factor 0") != std::string::npos);
}
