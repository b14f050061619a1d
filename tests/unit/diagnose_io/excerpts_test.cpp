#include "tools/diagnose/regression/excerpts.hpp"

#include <algorithm>

#include <doctest/doctest.h>

using namespace patella::diagnose;

namespace {

/// Every signal holds the number of its row.
Recording counted(std::size_t rows, std::vector<Segment> segments) {
  Recording recording;
  recording.rate_Hz = 100.0;
  recording.joints = 2;
  recording.segments = std::move(segments);
  for (std::size_t i = 0; i < rows; ++i) {
    recording.time_s.push_back(static_cast<double>(i));
  }
  recording.position_rad = {recording.time_s, recording.time_s};
  recording.torque_Nm = {recording.time_s, recording.time_s};
  recording.activation[2] = recording.time_s;
  return recording;
}

std::size_t rowsIn(const Recording& recording) {
  std::size_t rows = 0;
  for (const Segment& segment : recording.segments) {
    rows += segment.end - segment.first;
  }
  return rows;
}

}  // namespace

TEST_CASE("a recording that is short enough stays as it is") {
  std::vector<Recording> recordings{counted(3000, {{.first = 0, .end = 3000}})};
  limitLength(recordings, 30.0, 2.0);
  CHECK(recordings[0].rows() == 3000);
  CHECK(recordings[0].segments.size() == 1);
  CHECK(recordings[0].warnings.empty());
}

TEST_CASE("a long recording leaves excerpts from beginning to end, every signal alike, and says so") {
  std::vector<Recording> recordings{counted(400000, {{.first = 0, .end = 400000}})};  // 4000 s
  limitLength(recordings, 60.0, 2.0);
  const Recording& cut = recordings[0];
  REQUIRE(cut.segments.size() == 4);
  CHECK(cut.rows() == rowsIn(cut));
  CHECK(cut.rows() == doctest::Approx(6000).epsilon(0.001));
  for (std::size_t s = 0; s < 4; ++s) {
    const Segment& segment = cut.segments[s];
    CHECK(segment.end - segment.first == doctest::Approx(1500).epsilon(0.001));
    // In the middle of its quarter.
    CHECK(cut.time_s[(segment.first + segment.end) / 2] ==
          doctest::Approx(100000.0 * (static_cast<double>(s) + 0.5)).epsilon(0.001));
    for (std::size_t i = segment.first + 1; i < segment.end; ++i) {
      REQUIRE(cut.time_s[i] == cut.time_s[i - 1] + 1.0);
    }
  }
  CHECK(cut.position_rad[1] == cut.time_s);
  CHECK(cut.torque_Nm[0] == cut.time_s);
  CHECK(cut.activation[2] == cut.time_s);
  CHECK(cut.velocity_rad_s[0].empty());
  REQUIRE(cut.warnings.size() == 1);
  CHECK(cut.warnings[0] == "of 4000 s, 4 stretches of 15 s are analysed, spread evenly");
}

TEST_CASE("no excerpt bridges a gap") {
  std::vector<Recording> recordings{
      counted(50000, {{.first = 0, .end = 12500}, {.first = 12500, .end = 50000}})};
  limitLength(recordings, 150.0, 2.0);
  const Recording& cut = recordings[0];
  CHECK(cut.rows() == doctest::Approx(15000).epsilon(0.001));
  for (const Segment& segment : cut.segments) {
    const double first = cut.time_s[segment.first];
    const double last = cut.time_s[segment.end - 1];
    CHECK((last < 12500.0) == (first < 12500.0));
    CHECK(last - first == static_cast<double>(segment.end - segment.first - 1));
  }
}

TEST_CASE("of several recordings the short ones stay whole") {
  std::vector<Recording> recordings{counted(1000, {{.first = 0, .end = 1000}}),
                                    counted(100000, {{.first = 0, .end = 100000}}),
                                    counted(200000, {{.first = 0, .end = 200000}})};
  limitLength(recordings, 110.0, 2.0);
  CHECK(recordings[0].rows() == 1000);
  CHECK(recordings[1].rows() == doctest::Approx(5000).epsilon(0.001));
  CHECK(recordings[2].rows() == doctest::Approx(5000).epsilon(0.001));
}

TEST_CASE("of many recordings each keeps what can be analysed") {
  std::vector<Recording> recordings(40, counted(3000, {{.first = 0, .end = 3000}}));
  limitLength(recordings, 150.0, 7.5);
  for (const Recording& recording : recordings) {
    CHECK(recording.rows() == doctest::Approx(750).epsilon(0.01));
  }
}

TEST_CASE("postures at rest have no length") {
  Recording postures = counted(100000, {{.first = 0, .end = 100000}});
  postures.is_static = true;
  std::vector<Recording> recordings{postures};
  limitLength(recordings, 1.0, 2.0);
  CHECK(recordings[0].rows() == 100000);
}
