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

TEST_CASE("a separator that is not the comma is named") {
  CHECK(refusedHeader("t_s;q1_rad;tau1_Nm") ==
        std::string("run.csv:1: there is no column 't_s', nor 'q1_rad', 'tau1_Nm'; the columns seem to be "
                    "separated by semicolons, expected commas") +
            kOtherwise);
  CHECK(refusedHeader("t_s\tq1_rad\ttau1_Nm").find("separated by tabs, expected commas") !=
        std::string::npos);
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
        "run.csv:1: there is no column 't', nor 'q', 'm'; the columns seem to be separated by semicolons, "
        "expected commas");
  CHECK(mappedRefusal(map, text("t,q,M")) ==
        "run.csv:1: there is no column 'm', did you mean 'M'?; the file has 't', 'q', 'M'");
}
