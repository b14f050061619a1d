#include "drivers/can/crc8.hpp"

#include <array>
#include <cstdint>

#include <doctest/doctest.h>

using namespace patella::can;

TEST_CASE("CRC-8 SAE J1850 has the check value of the CRC catalogue") {
  constexpr std::array<std::uint8_t, 9> kDigits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  Crc8 crc;
  crc.add(kDigits);
  CHECK(crc.value() == 0x4B);
  CHECK(Crc8().value() == 0x00);
}

TEST_CASE("a frame's CRC covers its identifier and all data but itself") {
  Frame frame;
  frame.id = 0x110;
  frame.length = 8;
  frame.data = {1, 2, 3, 4, 5, 6, 7, 0};
  const std::uint8_t crc = frameCrc(frame, 7);
  Crc8 by_hand;
  by_hand.add(std::array<std::uint8_t, 9>{0x10, 0x01, 1, 2, 3, 4, 5, 6, 7});
  CHECK(crc == by_hand.value());

  SUBCASE("the CRC's own byte does not matter") {
    frame.data[7] = 0xA5;
    CHECK(frameCrc(frame, 7) == crc);
  }
  SUBCASE("each single flipped bit is seen") {
    for (unsigned bit = 0; bit < 56; ++bit) {
      Frame flipped = frame;
      flipped.data[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      CHECK(frameCrc(flipped, 7) != crc);
    }
  }
  SUBCASE("the same data under another identifier are seen") {
    frame.id = 0x111;
    CHECK(frameCrc(frame, 7) != crc);
    frame.id = 0x210;
    CHECK(frameCrc(frame, 7) != crc);
  }
  SUBCASE("the byte may stand anywhere") {
    frame.data[0] = 0x77;
    const std::uint8_t first = frameCrc(frame, 0);
    frame.data[0] = 0x78;
    CHECK(frameCrc(frame, 0) == first);
    CHECK(frameCrc(frame, 7) != first);
  }
}

TEST_CASE(
    "errors of one and two bits in a frame of eight bytes are always found, of three all but one in 210") {
  // The code is linear: an error passes where its own remainder, from a register of zeros, is zero.
  constexpr std::size_t kBits = 64;
  std::array<std::uint8_t, kBits> remainder{};
  for (std::size_t bit = 0; bit < kBits; ++bit) {
    std::uint8_t state = 0;
    for (std::size_t byte = 0; byte < 7; ++byte) {
      state = kCrc8Table[state ^ (bit / 8 == byte ? 1U << (bit % 8) : 0U)];
    }
    remainder[bit] = bit / 8 == 7 ? static_cast<std::uint8_t>(1U << (bit % 8)) : state;
  }
  int pairs = 0;
  int triples = 0;
  int all_triples = 0;
  for (std::size_t i = 0; i < kBits; ++i) {
    CHECK(remainder[i] != 0);
    for (std::size_t j = 0; j < i; ++j) {
      pairs += remainder[i] == remainder[j] ? 1 : 0;
      for (std::size_t k = 0; k < j; ++k) {
        triples += (remainder[i] ^ remainder[j]) == remainder[k] ? 1 : 0;
        ++all_triples;
      }
    }
  }
  CHECK(pairs == 0);
  CHECK(all_triples == 41664);
  CHECK(triples == 198);
}
