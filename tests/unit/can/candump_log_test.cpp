#include "drivers/can/candump_log.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/can/temporary_file.hpp"

using namespace patella::can;

namespace {

std::string roundTrip(std::string_view line) {
  LogEntry entry;
  parseLogLine(line, entry);
  std::array<char, kMaxLogLine> out;
  return std::string(out.data(), formatLogLine(out, entry));
}

std::string errorOf(std::string_view line) {
  LogEntry entry;
  try {
    parseLogLine(line, entry);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("every kind of line is understood and written back byte for byte") {
  const std::string all_fd = "(1604665770.960915) can0 12345678##5" + std::string(128, 'A');
  for (const std::string& line : std::vector<std::string>{
           "(1604665770.960915) can0 202#9019F50000000000", "(0000000000.000001) vcan17 7FF#",
           "(1604665770.999999) can0 00000001#00", "(1604665770.000000) can0 1FFFFFFF#1122334455667788",
           "(1604665770.960915) can0 123#R", "(1604665770.960915) can0 12345678#R8",
           "(1604665770.960915) can0 20000040#0000000000000000", "(1604665770.960915) can0 123##0",
           "(1604665770.960915) can0 123##5112233445566778899AABBCC", "(9000000000.960915) can0 123##F01",
           all_fd, "(1604665770.960915) can0 202#90 R", "(1604665770.960915) can0 202#90 T"}) {
    CAPTURE(line);
    CHECK(roundTrip(line) == line + "\n");
  }
}

TEST_CASE("the fields of a line are those of the frame") {
  LogEntry entry;
  parseLogLine("(1604665770.960915) can0 202#9019F50000000000 T\r", entry);
  CHECK(entry.frame.wall_ns == 1604665770'960915'000);
  CHECK(entry.interface == "can0");
  CHECK(entry.frame.id == 0x202);
  CHECK_FALSE(entry.frame.extended);
  CHECK(entry.frame.length == 8);
  CHECK(entry.frame.data[1] == 0x19);
  CHECK(entry.frame.own);

  parseLogLine("(1604665770.960915)   can0   00000202##100112233445566778899AABB", entry);
  CHECK(entry.frame.extended);
  CHECK(entry.frame.fd);
  CHECK(entry.frame.bit_rate_switch);
  CHECK(entry.frame.length == 12);
  CHECK_FALSE(entry.frame.own);

  parseLogLine("(1604665770.960915123) can0 20000104#0030", entry);
  CHECK(entry.frame.wall_ns == 1604665770'960915'123);
  CHECK(entry.frame.error);
  CHECK(entry.frame.id == 0x104);

  parseLogLine("(1604665770.960915) can0 123#R4", entry);
  CHECK(entry.frame.remote);
  CHECK(entry.frame.length == 4);
}

TEST_CASE("a frame is written with the flags that its kernel would give it, and only where there is room") {
  Frame frame;
  frame.id = 0x80;
  frame.length = 2;
  frame.data = {0xAB, 0xCD};
  frame.wall_ns = 1'700'000'000'123'456'789;
  std::array<char, kMaxLogLine> out;
  const std::string_view expected = "(1700000000.123456) can0 080#ABCD\n";
  CHECK(std::string_view(out.data(), formatLogLine(out, frame, "can0")) == expected);
  CHECK(formatLogLine(std::span(out).first(expected.size()), frame, "can0") == expected.size());
  CHECK(formatLogLine(std::span(out).first(expected.size() - 1), frame, "can0") == 0);
  frame.fd = true;
  CHECK(std::string_view(out.data(), formatLogLine(out, frame, "can0")).ends_with(" 080##4ABCD\n"));
  frame.bit_rate_switch = true;
  CHECK(std::string_view(out.data(), formatLogLine(out, frame, "can0")).ends_with(" 080##5ABCD\n"));
}

TEST_CASE("a line that is none is refused with what was found and expected") {
  CHECK(errorOf("hello") == "found 'hello', expected a stamp such as (1604665770.960915)");
  CHECK(errorOf("(1604665770.9609) can0 1#") ==
        "found '(1604665770.9609)', expected a stamp such as (1604665770.960915)");
  CHECK(errorOf("(16046657x0.960915) can0 123#").starts_with("found '(16046657x0.960915)'"));
  CHECK(errorOf("(99999999999999.960915) can0 123#").starts_with("found '(9999"));
  CHECK(errorOf("(1604665770.960915)").starts_with("the line ends, expected an interface's name"));
  CHECK(errorOf("(1604665770.960915) can0") == "the line ends, expected a frame such as 202#9019F500");
  CHECK(errorOf("(1604665770.960915) can0 12#00") ==
        "found '12', expected an identifier of 3 or 8 hexadecimal digits");
  CHECK(errorOf("(1604665770.960915) can0 800#00") == "found '800', expected an identifier of at most 7FF");
  CHECK(errorOf("(1604665770.960915) can0 40000000#00").ends_with("at most 1FFFFFFF"));
  CHECK(errorOf("(1604665770.960915) can0 123#001") ==
        "found '001', expected an even number of hexadecimal digits");
  CHECK(errorOf("(1604665770.960915) can0 123#0G") == "found '0G', expected hexadecimal digits of data");
  CHECK(errorOf("(1604665770.960915) can0 123#112233445566778899").ends_with("at most 8 bytes of data"));
  CHECK(errorOf("(1604665770.960915) can0 123##1112233445566778899").ends_with("a length that CAN FD has"));
  CHECK(errorOf("(1604665770.960915) can0 123##").ends_with("one hexadecimal digit"));
  CHECK(errorOf("(1604665770.960915) can0 123#R9").ends_with("R or R with a length of at most 8"));
  CHECK(
      errorOf("(1604665770.960915) can0 123#00 X").ends_with("the direction R or T, or the end of the line"));
  CHECK(errorOf("(1604665770.960915) can0 123#00 R junk") == "found 'junk', expected the end of the line");
}

TEST_CASE("a log that was cut at any byte is read up to there, and it is told where") {
  const std::string line = "(1604665770.960915) can0 202#9019F50000000000\n";
  const std::string whole = line + line + line;
  int cut = 0;
  for (std::size_t size = line.size(); size <= whole.size(); ++size) {
    const test::TemporaryFile file(whole.substr(0, size));
    CandumpReader reader(file.path());
    LogEntry entry;
    std::size_t frames = 0;
    while (reader.next(entry)) {
      ++frames;
    }
    CAPTURE(size);
    const std::size_t complete = size / line.size();
    // Cut after some data, a line is a shorter frame; its message's length and CRC tell.
    CHECK(frames >= complete);
    CHECK(frames <= complete + 1);
    CHECK((reader.cutLine() == 0 || (reader.cutLine() == complete + 1 && frames == complete)));
    cut += reader.cutLine() != 0 ? 1 : 0;
  }
  CHECK(cut > 50);
}

TEST_CASE("a file is read line by line, with or without a last line feed, and errors are located") {
  const test::TemporaryFile good(
      "(0000000001.000000) can0 123#01\n\n(0000000001.000001) can0 123#02\r\n(0000000001.000002) can0 "
      "123#03");
  CandumpReader reader(good.path());
  LogEntry entry;
  for (std::uint8_t i = 1; i <= 3; ++i) {
    REQUIRE(reader.next(entry));
    CHECK(entry.frame.data[0] == i);
  }
  CHECK_FALSE(reader.next(entry));

  const test::TemporaryFile bad("(0000000001.000000) can0 123#01\n(0000000001.000001) can0 123\n");
  CandumpReader bad_reader(bad.path());
  CHECK(bad_reader.next(entry));
  CHECK_THROWS_WITH_AS(
      bad_reader.next(entry),
      (bad.path().string() + ":2: found '123', expected a frame such as 202#9019F500").c_str(), LogError);
  CHECK_THROWS_WITH_AS(CandumpReader("/nonexistent.log"),
                       "/nonexistent.log: cannot be opened: No such file or directory", LogError);
  CHECK_THROWS_AS(CandumpReader("/"), LogError);
}
