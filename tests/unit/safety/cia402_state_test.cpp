// The states of CiA 402 over all 65,536 status words, against a table of the bits written out by hand, and
// where the controlwords lead a drive.
#include "core/safety/cia402_state.hpp"

#include <array>
#include <string_view>

#include <doctest/doctest.h>

using namespace patella::safety;

namespace {

/// Bits 6, 5, 3, 2, 1, 0 of the status word as the standard prints them; x does not count.
struct Printed {
  std::string_view bits;
  Cia402State state;
};

constexpr std::array<Printed, 8> kPrinted = {{{"0x0000", Cia402State::kNotReady},
                                              {"1x0000", Cia402State::kSwitchOnDisabled},
                                              {"010001", Cia402State::kReady},
                                              {"010011", Cia402State::kSwitchedOn},
                                              {"010111", Cia402State::kOperationEnabled},
                                              {"000111", Cia402State::kQuickStop},
                                              {"0x1111", Cia402State::kFaultReaction},
                                              {"0x1000", Cia402State::kFault}}};

bool fits(std::string_view bits, unsigned word) {
  constexpr std::array<unsigned, 6> kPlaces = {6, 5, 3, 2, 1, 0};
  for (std::size_t i = 0; i < kPlaces.size(); ++i) {
    const bool set = (word >> kPlaces[i] & 1U) != 0;
    if (bits[i] != 'x' && (bits[i] == '1') != set)
      return false;
  }
  return true;
}

}  // namespace

TEST_CASE("every status word is the one state whose bits it has, or none") {
  std::array<int, kCia402StateCount> words{};
  int wrong = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    Cia402State expected = Cia402State::kUndefined;
    int matches = 0;
    for (const Printed& printed : kPrinted) {
      if (fits(printed.bits, word)) {
        expected = printed.state;
        ++matches;
      }
    }
    const Cia402State state = cia402State(static_cast<std::uint16_t>(word));
    wrong += state != expected || matches > 1 ? 1 : 0;
    ++words[static_cast<std::size_t>(state)];
  }
  CHECK(wrong == 0);
  CHECK(words == std::array<int, kCia402StateCount>{2048, 2048, 1024, 1024, 1024, 1024, 2048, 2048, 53248});
}

TEST_CASE("no status word but operation enabled passes for enabled, and none without a fault for one") {
  int wrong = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const Cia402State state = cia402State(static_cast<std::uint16_t>(word));
    const bool enabled = (word & kCia402EnabledMask) == kCia402EnabledValue;
    wrong += enabled != (state == Cia402State::kOperationEnabled) ? 1 : 0;
    const bool fault = (word & kCia402FaultMask) != 0;
    const bool faulty = state == Cia402State::kFault || state == Cia402State::kFaultReaction;
    wrong += faulty && !fault ? 1 : 0;
    wrong += fault && !faulty && state != Cia402State::kUndefined ? 1 : 0;
  }
  CHECK(wrong == 0);
}

TEST_CASE("controlwords: with enable, without, and with a reset") {
  struct Row {
    unsigned status;
    unsigned with;
    unsigned without;
    unsigned reset;
  };
  constexpr std::array<Row, 9> kRows = {{{0x0000, 0x00, 0x00, 0x00},
                                         {0x0040, 0x06, 0x06, 0x06},
                                         {0x0021, 0x07, 0x06, 0x06},
                                         {0x0023, 0x0F, 0x06, 0x06},
                                         {0x0027, 0x0F, 0x06, 0x06},
                                         {0x0007, 0x00, 0x00, 0x00},
                                         {0x000F, 0x00, 0x00, 0x00},
                                         {0x0008, 0x00, 0x00, 0x80},
                                         {0x0001, 0x00, 0x00, 0x00}}};
  for (const Row& row : kRows) {
    CAPTURE(row.status);
    const Cia402State state = cia402State(static_cast<std::uint16_t>(row.status));
    CHECK(cia402Controlword(state, true, false) == row.with);
    CHECK(cia402Controlword(state, false, false) == row.without);
    CHECK(cia402Controlword(state, false, true) == row.reset);
  }
}

TEST_CASE(
    "whatever a drive reports, no word enables operation without enable, and none both enables and resets") {
  int wrong = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const Cia402State state = cia402State(static_cast<std::uint16_t>(word));
    for (const bool enable : {false, true}) {
      for (const bool reset : {false, true}) {
        const unsigned control = cia402Controlword(state, enable, reset);
        const bool enables = (control & 0x0FU) == 0x0FU;
        wrong += enables && !enable ? 1 : 0;
        wrong += enables && (control & 0x80U) != 0 ? 1 : 0;
        wrong += (control & ~0x8FU) != 0 ? 1 : 0;
        wrong += (control & 0x80U) != 0 && !(reset && state == Cia402State::kFault) ? 1 : 0;
      }
    }
  }
  CHECK(wrong == 0);
}
