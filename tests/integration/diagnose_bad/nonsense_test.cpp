// Files that are no recordings of the model's machine in seconds, radians and newton metres: each is a sound
// one, spoilt in one way, and refused before anything is fitted, with the word that tells what is wrong.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/integration/diagnose_bad/spoilt_rigs.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/diagnose/checks/plausibility.hpp"
#include "tools/recordings/recording_file.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

/// A file before it is written.
struct Table {
  std::string header;
  std::vector<std::vector<double>> columns;  ///< time, positions, torques
  std::string text;                          ///< in place of the above, unless empty

  std::size_t rows() const { return columns[0].size(); }
  std::vector<double>& t() { return columns[0]; }
  std::vector<double>& q(std::size_t joint) { return columns[1 + joint]; }
  std::vector<double>& tau(std::size_t joint) { return columns[1 + (columns.size() - 1) / 2 + joint]; }
  std::size_t joints() const { return (columns.size() - 1) / 2; }

  std::string csv() const {
    if (!text.empty()) {
      return text;
    }
    std::string lines = header + "\n";
    for (std::size_t row = 0; row < rows(); ++row) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        lines += c == 0 ? "" : ",";
        lines += std::isfinite(columns[c][row]) ? fmt::format("{:.15g}", columns[c][row]) : "";
      }
      lines += "\n";
    }
    return lines;
  }
  void scaleTorque(double factor) {
    for (std::size_t j = 0; j < joints(); ++j) {
      scale(tau(j), factor);
    }
  }
  void scaleAngle(double factor) {
    for (std::size_t j = 0; j < joints(); ++j) {
      scale(q(j), factor);
    }
  }
  void keepEvery(std::size_t step) {
    for (std::vector<double>& column : columns) {
      for (std::size_t i = 0; i * step < column.size(); ++i) {
        column[i] = column[i * step];
      }
      column.resize((column.size() + step - 1) / step);
    }
  }
  void cut(std::size_t rows) {
    for (std::vector<double>& column : columns) {
      column.resize(rows);
    }
  }
};

Table tableOf(const SpoiltRig& rig) {
  const Recording recording = rig.record();
  Table table{.header = "t_s", .columns = {recording.time_s}, .text = {}};
  for (int j = 0; j < recording.joints; ++j) {
    table.header += fmt::format(",q{}_rad", j + 1);
    table.columns.push_back(recording.position_rad[static_cast<std::size_t>(j)]);
  }
  for (int j = 0; j < recording.joints; ++j) {
    table.header += fmt::format(",tau{}_Nm", j + 1);
    table.columns.push_back(recording.torque_Nm[static_cast<std::size_t>(j)]);
  }
  return table;
}

/// Outcome for a file: read, and judged with the model.
Recording judged(const Table& table, const model::ModelDescription& model) {
  const ScratchFolder folder;
  app::writeFile(folder / "run.csv", table.csv());
  Recording recording = loadRecording(folder / "run.csv", {.joints = model.joints()});
  requirePlausible(std::span(&recording, 1), model);
  return recording;
}

std::string refusal(const Table& table, const model::ModelDescription& model) {
  try {
    judged(table, model);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "not refused";
}

bool warns(const Recording& recording, const std::string& phrase) {
  for (const std::string& warning : recording.warnings) {
    if (warning.find(phrase) != std::string::npos) {
      return true;
    }
  }
  return false;
}

struct Nonsense {
  const char* what;
  const char* mechanism;
  std::function<void(Table&)> spoil;
  const char* word;  ///< of the refusal
};

constexpr double kDegrees = 180.0 / std::numbers::pi;

void checkAll(const std::vector<Nonsense>& all) {
  for (const char* mechanism : {"knee", "light_arm"}) {
    const SpoiltRig rig = rubbingRig(mechanism, 2);
    const Table sound = tableOf(rig);
    const model::ModelDescription model = rig.model();
    REQUIRE_NOTHROW(judged(sound, model));
    for (const Nonsense& nonsense : all) {
      if (std::string(nonsense.mechanism) == mechanism) {
        Table table = sound;
        nonsense.spoil(table);
        const std::string message = refusal(table, model);
        CAPTURE(nonsense.what);
        CAPTURE(message);
        CHECK(message.find("run.csv") != std::string::npos);
        CHECK(message.find(nonsense.word) != std::string::npos);
      }
    }
  }
}

}  // namespace

TEST_CASE("units of torque are told from the model and the motion") {
  checkAll({
      {"kN·m", "knee", [](Table& t) { t.scaleTorque(1e-3); }, "kN·m"},
      {"kN·m", "light_arm", [](Table& t) { t.scaleTorque(1e-3); }, "kN·m"},
      {"kN·m, one joint", "light_arm", [](Table& t) { scale(t.tau(1), 1e-3); }, "tau2_Nm is in kN·m"},
      {"mN·m", "knee", [](Table& t) { t.scaleTorque(1e3); }, "mN·m"},
      {"mN·m", "light_arm", [](Table& t) { t.scaleTorque(1e3); }, "mN·m"},
      {"N·cm", "knee", [](Table& t) { t.scaleTorque(100.0); }, "N·cm"},
      {"kgf·m", "light_arm", [](Table& t) { t.scaleTorque(1.0 / 9.80665); }, "kgf·m"},
      {"kgf·cm", "knee", [](Table& t) { t.scaleTorque(10.197); }, "kgf·cm"},
      {"lbf·in", "light_arm", [](Table& t) { t.scaleTorque(8.8507); }, "lbf·in"},
  });
}

TEST_CASE("units of angles are told from their size, or from the model") {
  checkAll({
      {"turns", "knee", [](Table& t) { t.scaleAngle(0.5 / std::numbers::pi); }, "turns"},
      {"turns", "light_arm", [](Table& t) { t.scaleAngle(0.5 / std::numbers::pi); }, "turns"},
      {"degrees", "knee", [](Table& t) { t.scaleAngle(kDegrees); }, "degrees"},
      {"degrees, one joint", "light_arm", [](Table& t) { scale(t.q(1), kDegrees); }, "q2_rad is "},
      {"milliradians", "knee", [](Table& t) { t.scaleAngle(1e3); }, "milliradians"},
      {"counts", "light_arm", [](Table& t) { t.scaleAngle(65536.0 / 6.2831853); }, "counts of an encoder"},
  });
}

TEST_CASE("units of time are told from the step, and a rate too low from the motion") {
  checkAll({
      {"milliseconds", "knee", [](Table& t) { scale(t.t(), 1e3); }, "t_s steps by 1: looks like millisec"},
      {"microseconds", "knee", [](Table& t) { scale(t.t(), 1e6); }, "looks like microseconds"},
      {"nanoseconds", "light_arm", [](Table& t) { scale(t.t(), 1e9); }, "looks like nanoseconds"},
      {"minutes", "knee", [](Table& t) { scale(t.t(), 1.0 / 60.0); }, "looks like minutes"},
      {"hours", "knee", [](Table& t) { scale(t.t(), 1.0 / 3600.0); }, "looks like hours"},
      {"Unix milliseconds", "light_arm",
       [](Table& t) {
         for (double& value : t.t()) {
           value = 1.7e12 + 1e3 * value;
         }
       },
       "looks like milliseconds"},
      {"10 Hz", "knee", [](Table& t) { t.keepEvery(100); }, "sampled at 10 Hz"},
      {"20 Hz", "light_arm", [](Table& t) { t.keepEvery(50); }, "Hz are needed for this motion"},
      {"all at once", "knee", [](Table& t) { scale(t.t(), 0.0); }, "complete rows, expected at least"},
      {"backwards", "knee", [](Table& t) { scale(t.t(), -1.0); }, "expected it to increase"},
      {"too short", "knee", [](Table& t) { t.cut(1500); }, "expected at least 2 s"},
      {"one row", "knee", [](Table& t) { t.cut(1); }, "1 complete rows"},
      {"no row", "knee", [](Table& t) { t.cut(0); }, "0 rows of numbers"},
  });
}

namespace {

void manyColumns(Table& table, int columns) {
  table.text = "t_s,q1_rad,tau1_Nm";
  for (int i = 0; i < columns; ++i) {
    table.text += fmt::format(",c{}", i);
  }
  table.text += "\n0,0,0\n";
}

}  // namespace

TEST_CASE("files that are broken are refused by line or column") {
  checkAll({
      {"many outliers", "knee",
       [](Table& t) {
         for (std::size_t i = 0; i < t.rows(); i += 90) {
           t.tau(0)[i] = 1e6;
         }
       },
       "which no motion and no drive explains"},
      {"a torque that overflowed", "light_arm",
       [](Table& t) {
         for (std::size_t i = 4000; i < 4300; ++i) {
           t.tau(1)[i] = 1e9;
         }
       },
       "torque of joint 2 is 1e+09"},
      {"empty cells", "knee",
       [](Table& t) {
         for (std::size_t i = 3; i < t.rows(); i += 5) {
           t.q(0)[i] = std::numeric_limits<double>::quiet_NaN();
         }
       },
       "position of joint 1 has no value"},
      {"names without units", "knee", [](Table& t) { t.header = "t,q1,tau1"; }, "there is no column 't_s'"},
      {"no names", "knee", [](Table& t) { t.header = "0,0.1,0.2"; }, "the first line holds numbers"},
      {"a name twice", "light_arm", [](Table& t) { t.header = "t_s,q1_rad,q1_rad,tau1_Nm,tau2_Nm"; },
       "'q1_rad' is repeated"},
      {"more joints", "knee", [](Table& t) { t.header = "t_s,q1_rad,q2_rad"; }, "column 'q2_rad'"},
      {"fewer joints", "light_arm", [](Table& t) { t.header = "t_s,q1_rad,a,tau1_Nm,b"; }, "'q2_rad'"},
      {"decimal commas", "knee", [](Table& t) { t.text = "t_s;q1_rad;tau1_Nm\n0,001;0,5;0,25\n"; },
       "there is no column 't_s'"},
      {"text", "knee", [](Table& t) { t.text = "t_s,q1_rad,tau1_Nm\n0.001,OL,0.25\n"; }, "value 'OL'"},
      {"nothing", "knee", [](Table& t) { t.text = "\n"; }, "the file is empty"},
      {"a hundred thousand columns", "knee", [](Table& t) { manyColumns(t, 100'000); },
       "3 cells, expected 100003"},
      {"a million columns", "knee", [](Table& t) { manyColumns(t, 1'000'000); }, "the line is too long"},
  });
}

TEST_CASE("what is unusual and no nonsense is believed") {
  const SpoiltRig rig = rubbingRig("light_arm", 2);
  const model::ModelDescription model = rig.model();
  Table table = tableOf(rig);
  SUBCASE("stamps of a wall clock") {
    for (double& value : table.t()) {
      value += 1.7e9;
    }
  }
  SUBCASE("stamps that begin below zero") {
    for (double& value : table.t()) {
      value -= 7.0;
    }
  }
  SUBCASE("a clock that was set on the way") {
    for (std::size_t i = table.rows() / 2; i < table.rows(); ++i) {
      table.t()[i] += 1e6;
    }
    CHECK(warns(judged(table, model), "1 gap of up to 1e+06 s"));
  }
  SUBCASE("a model that is a third too light") {
    table.scaleTorque(1.4);
  }
  const Recording recording = judged(table, model);
  CHECK(recording.time_s.front() == 0.0);
  CHECK(recording.rate_Hz == doctest::Approx(1000.0).epsilon(0.01));
}

TEST_CASE("rows that no motion and no drive explains are left out by name, and hide nothing") {
  const SpoiltRig rig = rubbingRig("knee", 1);
  Table table = tableOf(rig);
  std::string named;
  SUBCASE("one torque of 1e9 N·m") {
    table.tau(0)[7000] = 1e9;
    named = "run.csv:7002: torque of joint 1 is 1e+09 at 7";
  }
  SUBCASE("an encoder that misses a turn for three rows") {
    for (std::size_t i = 3000; i < 3003; ++i) {
      table.q(0)[i] += 2.0 * std::numbers::pi;
    }
    named = "run.csv:3002: position of joint 1 is ";
  }
  SUBCASE("an encoder whose bit flips, within the range of the motion") {
    const auto [low, high] = std::minmax_element(table.q(0).begin(), table.q(0).end());
    table.q(0)[9000] = table.q(0)[9000] < 0.5 * (*low + *high) ? *high : *low;
    named = "run.csv:9002: position of joint 1 is ";
  }
  const Recording recording = judged(table, rig.model());
  CAPTURE(named);
  CHECK(warns(recording, named));
  CHECK(warns(recording, "the row is left out"));
  const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK_FALSE(claimsSomethingElse(diagnosis));
}

TEST_CASE(
    "a joint that does not move is named where nothing is found, which is not to say that nothing is "
    "missing") {
  SpoiltRig rig = rubbingRig("light_arm", 2);
  rig.effects.clear();
  rig.rig.reference[1].harmonics.clear();
  Recording recording = rig.record();
  const double rest_rad = recording.position_rad[1].front();
  std::fill(recording.position_rad[1].begin(), recording.position_rad[1].end(), rest_rad);
  const Diagnosis diagnosis = diagnosed(std::span(&recording, 1), rig.model());
  CAPTURE(diagnosis.explanation);
  CHECK(diagnosis.verdict != Verdict::kNothingMissing);
  CHECK(diagnosis.verdict == Verdict::kInsufficientExcitation);
  CHECK(diagnosis.explanation.find("oint 2") != std::string::npos);
}
