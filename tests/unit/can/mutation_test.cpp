// Damaged files are refused or read, but never crash the reader. Under AddressSanitizer this also shows that
// no byte outside them is touched.
#include <array>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>

#include <doctest/doctest.h>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/signal_codec.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella::can;

namespace {

std::string mutate(std::string text, std::mt19937& random) {
  constexpr std::string_view kTelling = "\"\\;:|@()[],+-0129mM#R \n\xB0\xC3";
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  const std::size_t changes = 1 + pick(4);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = pick(text.size());
    switch (pick(5)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = kTelling[pick(kTelling.size())];
        break;
      case 2:
        text.insert(at, 1, kTelling[pick(kTelling.size())]);
        break;
      case 3:
        text.erase(at, 1 + pick(20));
        break;
      default:
        text.resize(at);
        break;
    }
  }
  return text;
}

}  // namespace

TEST_CASE("a damaged bus description is read or refused at a line, and what is read can be used") {
  const std::string path = patella::checkout::source() / "drivers/can/patella.dbc";
  std::ifstream stream(path, std::ios::binary);
  const std::string original{std::istreambuf_iterator<char>(stream), {}};
  REQUIRE(original.size() > 1000);
  std::mt19937 random(2023);
  int refused = 0;
  int read = 0;
  Frame frame;
  for (int i = 0; i < 3000; ++i) {
    try {
      const Database database = parseDbc(mutate(original, random), "damaged.dbc");
      ++read;
      for (const Message& message : database.messages) {
        for (const Signal& signal : message.signals) {
          try {
            const CompiledSignal codec(message, signal);
            frame.length = static_cast<std::uint8_t>(random() % 65);
            codec.encode(frame, codec.decode(frame));
          } catch (const std::invalid_argument&) {
          }
        }
      }
    } catch (const DbcError& error) {
      ++refused;
      REQUIRE(std::string_view(error.what()).starts_with("damaged.dbc:"));
    }
  }
  CHECK(read > 100);
  CHECK(refused > 1000);
}

TEST_CASE("a damaged log line is read or refused, and what is read can be written") {
  const std::array<std::string, 5> originals = {
      "(1604665770.960915) can0 202#9019F50000000000",
      "(1604665770.960915) can0 12345678##5112233445566778899AABBCC", "(1604665770.960915) can0 123#R8",
      "(1604665770.960915) can0 20000040#0000000000000000 R", "(1604665770.960915) vcan12 7FF#"};
  std::mt19937 random(7);
  int refused = 0;
  int read = 0;
  for (int i = 0; i < 50000; ++i) {
    LogEntry entry;
    try {
      parseLogLine(mutate(originals[static_cast<std::size_t>(i) % originals.size()], random), entry);
      ++read;
      std::array<char, kMaxLogLine> out;
      const std::size_t size = formatLogLine(out, entry);
      REQUIRE(size > 0);
      LogEntry again;
      parseLogLine(std::string_view(out.data(), size - 1), again);
      REQUIRE(again.frame.data == entry.frame.data);
      REQUIRE(again.frame.id == entry.frame.id);
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  CHECK(read > 1000);
  CHECK(refused > 10000);
}
