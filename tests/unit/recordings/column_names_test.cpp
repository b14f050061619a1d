// What a reader says of a header that lacks what it needs.
#include <doctest/doctest.h>

#include "tests/unit/recordings/mapped.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;
using patella::test::mappedRefusal;
using patella::test::refusal;

namespace {

const char* const kOtherwise = "; otherwise, expected a map of the columns (--columns)";
const char* const kSemicolons =
    "the columns seem to be separated by semicolons, expected commas, or a map of the columns (--columns) "
    "with "
    "delimiter = \"semicolon\"";

std::string refusedHeader(const std::string& header, int joints = 1) {
  return refusal(csv(header, 300, [](int) { return std::string("0"); }), {.joints = joints});
}

}  // namespace

TEST_CASE("a header of other names is listed, and none of it suggested") {
  CHECK(refusedHeader("time,hip,knee,t1,t2", 2) ==
        std::string("run.csv:1: there is no column 't_s', nor 'q1_rad', 'tau1_Nm', 'q2_rad', 'tau2_Nm'; the "
                    "file has 'time', 'hip', 'knee', 't1', 't2'") +
            kOtherwise);
}

TEST_CASE("a column that is in use is not suggested for one that is missing") {
  CHECK(refusedHeader("t_s,q1_rad,tau1_Nm,q2_rad", 2) ==
        std::string("run.csv:1: there is no column 'tau2_Nm'; the file has 't_s', 'q1_rad', 'tau1_Nm', "
                    "'q2_rad'") +
            kOtherwise);
  CHECK(refusedHeader("t_s,q1_rad,tau1_Nm,q2_rad,tau2", 2).find("did you mean 'tau2'?") != std::string::npos);
}

TEST_CASE("a separator that is not the comma is named, with what a map says of it") {
  const std::string missing = "run.csv:1: there is no column 't_s', nor 'q1_rad', 'tau1_Nm'; ";
  CHECK(refusedHeader("t_s;q1_rad;tau1_Nm") == missing + kSemicolons);
  CHECK(refusedHeader("t_s\tq1_rad\ttau1_Nm").find("separated by tabs, expected commas") !=
        std::string::npos);
  CHECK(refusal("t_s;q1_rad;tau1_Nm\n0;0,5;1.234,5\n", {.joints = 1}) ==
        missing + kSemicolons + "; numbers have decimal commas, as '0,5', expected decimal points");
}

TEST_CASE("numbers with a decimal comma are told from other text, and from cells") {
  const auto refused = [](const std::string& row) {
    return refusal("t_s,q1_rad,tau1_Nm\n" + row + "\n", {.joints = 1});
  };
  CHECK(refused("\"0,001\",\"-1,5\",\"0,25\"") ==
        "run.csv:2: column 't_s': value '\"0,001\"', which has a decimal comma, expected a decimal point");
  CHECK(refused("0,0,5,0,25") ==
        "run.csv:2: 5 cells, expected 3 as in the header; if its numbers have decimal commas, expected "
        "decimal points");
  CHECK(refused("0,0.5,0,25") == "run.csv:2: 4 cells, expected 3 as in the header");
  CHECK(refused("0,5,25,") == "run.csv:2: 4 cells, expected 3 as in the header");
  for (const char* text : {"\"1,2,3\"", "\"1,2.5\"", "\"1,x\"", "\",\""}) {
    CAPTURE(text);
    CHECK(refused(std::string(text) + ",0,0").ends_with("', expected a number"));
  }
}

TEST_CASE("a column in another unit is not suggested under its name, but as a map has it") {
  const std::string map = "expected a map of the columns (--columns) with ";
  CHECK(refusedHeader("t_s,q1_deg,tau1_Nm") ==
        "run.csv:1: there is no column 'q1_rad'; 'q1_deg' has another unit than 'q1_rad', " + map +
            "position = { column = \"q1_deg\", unit = \"deg\" }");
  CHECK(refusedHeader("t_s,q1 [deg],tau1_Nm")
            .ends_with(map + "position = { column = \"q1 [deg]\", unit = \"deg\" }"));
  CHECK(refusedHeader("t_s,q1_rad,tau1_mNm")
            .ends_with(map + "torque = { column = \"tau1_mNm\", unit = \"mN.m\" }"));
  CHECK(
      refusedHeader("t_ms,q1_rad,tau1_Nm").ends_with(map + "time_column = \"t_ms\" and time_unit = \"ms\""));
  CHECK(refusedHeader("t_s,q1_counts,tau1_Nm").ends_with(kOtherwise));
}

TEST_CASE("a dozen columns are listed, the others counted") {
  std::string header = "c1";
  for (int i = 2; i <= 15; ++i) {
    header += fmt::format(",c{}", i);
  }
  CHECK(refusedHeader(header).find("'c11', 'c12' and 3 more;") != std::string::npos);
}

TEST_CASE("a map that asks for what the file does not have is told so, too") {
  const char* const map =
      "[recording]\ntime_column = \"t\"\ntorque = \"sampled\"\n[[joint]]\nposition = { column = \"q\" }\n"
      "torque = { column = \"m\" }\n";
  const auto text = [](const char* header) {
    return csv(header, 300, [](int) { return std::string("0,0,0"); });
  };
  CHECK(mappedRefusal(map, text("t;q;m")) ==
        std::string("run.csv:1: there is no column 't', nor 'q', 'm'; ") + kSemicolons);
  CHECK(mappedRefusal(map, text("t,q,M")) ==
        "run.csv:1: there is no column 'm', did you mean 'M'?; the file has 't', 'q', 'M'");
}
