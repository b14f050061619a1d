// Text in other forms than a table with a header and a column of time.
#include <doctest/doctest.h>

#include "tests/unit/recordings/mapped.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;
using patella::test::mapped;
using patella::test::mappedRefusal;

namespace {

std::string mapOf(const std::string& recording, const std::string& position = "'q'",
                  const std::string& torque = "'m'") {
  return "[recording]\ntorque = 'held'\n" + recording + "[[joint]]\nposition = { column = " + position +
         " }\ntorque = { column = " + torque + " }\n";
}

std::string rows(int count, const std::function<std::string(int)>& line) {
  return csv("", count, line).substr(1);
}

}  // namespace

TEST_CASE("a rate takes the place of a column of time") {
  const auto text = csv("q,m", 300, [](int i) { return fmt::format("{},{}", 0.01 * i, i); });
  const Recording recording = mapped(mapOf("rate_Hz = 500\n"), text);
  CHECK(recording.rate_Hz == 500.0);
  REQUIRE(recording.rows() == 300);
  CHECK(recording.time_s[299] == doctest::Approx(0.598));
  CHECK(recording.torque_Nm[0][123] == 123.0);
  // A row without a value is a lost sample, and not one less.
  const auto holed =
      csv("q,m", 300, [](int i) { return i == 100 ? std::string(",") : fmt::format("{},{}", 0.01 * i, i); });
  CHECK(mapped(mapOf("rate_Hz = 500\n"), holed).rows() == 300);
}

TEST_CASE("a rate beside a column of time, and neither, are refused") {
  const std::string text = csv("t,q,m", 300, [](int i) { return fmt::format("{},{},{}", 0.002 * i, i, i); });
  CHECK(mappedRefusal(mapOf("rate_Hz = 500\ntime_column = 't'\n"), text) ==
        "map.toml:3: key 'recording.rate_Hz': stands beside 'time_column', expected one of the two");
  CHECK(mappedRefusal(mapOf("rate_Hz = 500\nstatic = true\n"), text) ==
        "map.toml:3: key 'recording.rate_Hz': stands beside static = true, expected one of the two");
  CHECK(mappedRefusal(mapOf("rate_Hz = 0\n"), text) ==
        "map.toml:3: key 'recording.rate_Hz': value 0, expected a number in [2, 50000]");
  CHECK(
      mappedRefusal(mapOf(""), text) ==
      "map.toml:1: key 'recording.time_column' is missing, expected a string that is not empty, or 'rate_Hz' "
      "for a file without times");
}

TEST_CASE("columns of a file without header are found by number") {
  const std::string text = rows(300, [](int i) { return fmt::format("{},text,{},{}", 0.002 * i, i, -i); });
  const std::string form = "header = false\ntime_column = 1\n";
  const Recording recording = mapped(mapOf(form, "4", "3"), text);
  REQUIRE(recording.rows() == 300);
  CHECK(recording.rate_Hz == 500.0);
  CHECK(recording.torque_Nm[0].front() == 0.0);
  CHECK(recording.torque_Nm[0][123] == 123.0);
  CHECK(recording.position_rad[0][123] == doctest::Approx(-123.0));
  CHECK(mappedRefusal(mapOf(form, "5", "3"), text) == "run.csv:1: there is no column '5', expected 1 to 4");
  CHECK(mappedRefusal(mapOf(form, "2", "3"), text) ==
        "run.csv:1: column '2': value 'text', expected a number");
  CHECK(mappedRefusal(mapOf(form, "0", "3"), text) ==
        "map.toml:6: key 'joint[1].position.column': value 0, expected an integer in [1, 1000000]; columns "
        "have "
        "numbers where header = false");
  CHECK(mappedRefusal(mapOf(form, "'q'", "3"), text) ==
        "map.toml:6: key 'joint[1].position.column': value 'q', expected an integer in [1, 1000000]; columns "
        "have numbers where header = false");
  CHECK(mappedRefusal(mapOf("rate_Hz = 500\n", "3"), text) ==
        "map.toml:5: key 'joint[1].position.column': value 3, expected a string that is not empty; columns "
        "have "
        "names unless header = false");
  CHECK(mappedRefusal(mapOf(form, "1", "1"), "time,angle\n0,1\n") ==
        "run.csv:1: the first line holds no number, expected rows of numbers without a header");
  CHECK(mappedRefusal(mapOf(form, "1", "1"), "0,1\n1\n2,3\n") ==
        "run.csv:2: 1 cells, expected 2 as in the first line");
}

TEST_CASE("columns may be separated by runs of spaces and tabs") {
  const std::string text = "  t\tq  m \n" + rows(300, [](int i) {
                             return fmt::format(" {}  {}\t \t{}{}", 0.002 * i, i, -i, i % 2 == 0 ? " " : "");
                           });
  const Recording recording = mapped(mapOf("time_column = 't'\ndelimiter = 'space'\n"), text);
  REQUIRE(recording.rows() == 300);
  CHECK(recording.torque_Nm[0][123] == -123.0);
  const std::string bare =
      rows(300, [](int i) { return fmt::format("   {:8.3f} {:8.3f}", 0.002 * i, 1.0 * i); });
  CHECK(mapped(mapOf("header = false\ntime_column = 1\ndelimiter = 'space'\n", "2", "2"), bare)
            .torque_Nm[0][123] == 123.0);
  CHECK(mappedRefusal(mapOf("time_column = 't'\ndelimiter = 'space'\n"), "t q m\n0 1 2\n1 2\n2 3 4\n") ==
        "run.csv:3: 2 cells, expected 3 as in the header");
  CHECK(mappedRefusal(mapOf("time_column = 't'\ndelimiter = 'blank'\n"), text) ==
        "map.toml:4: key 'recording.delimiter': value 'blank', expected one of 'comma', 'semicolon', 'tab', "
        "'space'");
}

TEST_CASE("the last row of a recording that was cut off is left out with a warning, and no other") {
  const std::string map = mapOf("time_column = 't'\n");
  const std::string text = csv("t,q,m", 200, [](int i) { return fmt::format("{},{},{}", 0.002 * i, i, i); });
  for (const std::string rest : {"0.4", "0.4,20", "0.4,200,-", "0.4,2\n", "0.4,200,1e-"}) {
    CAPTURE(rest);
    const Recording recording = mapped(map, text + rest);
    CHECK(recording.rows() == 200);
    CHECK(
        test::warnsOf(recording, "run.csv:202: the last row is incomplete, as if cut off, and is left out"));
  }
  CHECK(mapped(map, text).warnings.empty());
  CHECK(mappedRefusal(map, text + "0.4,200\n0.402,201,1\n") ==
        "run.csv:202: 2 cells, expected 3 as in the header");
  CHECK(mappedRefusal(map, text + "0.4,x,1\n") == "run.csv:202: column 'q': value 'x', expected a number");
  CHECK(mappedRefusal(map, text + "0.4,200,1,1\n") == "run.csv:202: 4 cells, expected 3 as in the header");
  const std::string named =
      csv("t_s,q1_rad,tau1_Nm", 200, [](int i) { return fmt::format("{},{},{}", 0.002 * i, i, i); });
  CHECK(test::warnsOf(test::loaded(named + "0.4,2"), "run.csv:202: the last row is incomplete"));
}

TEST_CASE("matrices are of MATLAB files only") {
  CHECK(mappedRefusal(mapOf("rate_Hz = 500\n", "'q', index = 2"), "q,m\n0,1\n") ==
        "run.csv: 'index = 2' is given for column 'q', but text has no matrices, expected 'index' for .mat "
        "files "
        "only");
}
