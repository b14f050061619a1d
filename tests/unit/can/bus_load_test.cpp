// Bits on the wire, against the bounds of the literature and against stuffing counted bit by bit.
#include "drivers/can/bus_load.hpp"

#include <array>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/can/rig_map.hpp"

using namespace patella::can;

namespace {

/// Bits of a classic frame with an identifier of 11 bits and this data, stuff bits counted as they occur:
/// from start bit to the end of the CRC, then delimiter, acknowledge and its delimiter, end and pause.
int countedBits(unsigned id, const std::vector<unsigned>& data) {
  std::vector<bool> bits;
  const auto push = [&bits](unsigned value, int count) {
    for (int i = count - 1; i >= 0; --i)
      bits.push_back((value >> static_cast<unsigned>(i) & 1U) != 0);
  };
  push(0, 1);
  push(id, 11);
  push(0, 3);
  push(static_cast<unsigned>(data.size()), 4);
  for (const unsigned byte : data)
    push(byte, 8);
  unsigned crc = 0;
  for (const bool bit : bits) {
    const bool next = bit != ((crc >> 14U & 1U) != 0);
    crc = (crc << 1U & 0x7FFFU) ^ (next ? 0x4599U : 0U);
  }
  push(crc, 15);
  int stuffed = 0;
  int run = 0;
  bool last = true;
  for (const bool bit : bits) {
    run = bit == last ? run + 1 : 1;
    last = bit;
    if (run == 5) {
      ++stuffed;
      last = !bit;
      run = 1;
    }
  }
  return static_cast<int>(bits.size()) + stuffed + 3 + 7 + 3;
}

}  // namespace

TEST_CASE("bits of a frame at most: the figures of the literature, and never fewer than counted") {
  CHECK(mostBits(8, false, false) == 135);
  CHECK(mostBits(0, false, false) == 55);
  CHECK(mostBits(8, true, false) == 160);
  for (std::size_t bytes = 0; bytes <= 8; ++bytes) {
    int most = 0;
    for (const unsigned filler : {0x00U, 0xFFU, 0x0FU, 0x83U, 0x1FU, 0xE0U, 0x3CU, 0xC1U, 0x78U, 0x87U}) {
      for (const unsigned id : {0x000U, 0x001U, 0x021U, 0x3C3U, 0x7FFU, 0x0F0U, 0x478U})
        most = std::max(most, countedBits(id, std::vector<unsigned>(bytes, filler)));
    }
    CHECK(most <= mostBits(static_cast<int>(bytes), false, false));
    CHECK(most >= mostBits(static_cast<int>(bytes), false, false) - 8 - static_cast<int>(bytes));
  }
  CHECK(mostBits(64, false, true) > 8 * 64 + 64);
}

TEST_CASE("the load counts commands by the loop, sensors by their period, the rest by their cycle time") {
  const auto database = test::rigDatabase();
  const CommandMap command = test::commandMap();
  // Command, two encoders, status and EMG at 1 kHz, the operator by its cycle time; no truth.
  const BusLoad load = busLoad(database, test::rigMap(), {&command, 1}, 1000.0);
  CHECK(load.frames_per_s == doctest::Approx(5100.0));
  CHECK(load.bits_per_s == doctest::Approx(5100.0 * 135));

  CommandMap entering = command;
  entering.enter = {{"", std::vector<std::uint8_t>(8), ""}, {"", std::vector<std::uint8_t>(8), ""}};
  entering.enter_period_s = 0.01;
  CHECK(busLoad(database, test::rigMap(), {&entering, 1}, 1000.0).frames_per_s == doctest::Approx(5300.0));
  BusMap slow = test::rigMap();
  slow.encoder_period_s = 0.002;
  CHECK(busLoad(database, slow, {&command, 1}, 1000.0).frames_per_s == doctest::Approx(4100.0));
}
