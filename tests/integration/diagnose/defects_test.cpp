// One defect each: status 1, one line that says what is wrong and where, and nothing left behind.
#include <algorithm>
#include <utility>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/integration/diagnose/diagnose_process.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::test;

namespace {

/// A sound model and recording; tests spoil one of them.
class Bench {
 public:
  Bench() {
    app::writeFile(folder_ / "model.toml", kneeModel());
    app::writeFile(folder_ / "run.csv", kneeCsv(0.0, 4.0));
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { app::writeFile(folder_ / name, text); }

  /// Replaces the first place where `from` stands in a file.
  void replace(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = app::readFile(folder_ / name, test::kRecordingText);
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    write(name, text.replace(at, from.size(), to));
  }

  void expectRefused(const std::vector<std::string>& more, const std::vector<std::string>& says) const {
    std::vector<std::string> arguments;
    for (const auto& [name, value] :
         {std::pair{"--model", "model.toml"}, {"--data", "run.csv"}, {"--out", "new/out"}}) {
      if (std::find(more.begin(), more.end(), name) == more.end()) {
        arguments.insert(arguments.end(), {name, file(value)});
      }
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto before = listing(folder_.path());
    const Outcome outcome = diagnose(arguments);
    INFO(outcome.errors);
    CHECK(outcome.exit_status == 1);
    CHECK(outcome.output.empty());
    for (const std::string& phrase : says) {
      CAPTURE(phrase);
      CHECK(outcome.errors.find(phrase) != std::string::npos);
    }
    const bool nothing_left_behind = listing(folder_.path()) == before;
    CHECK(nothing_left_behind);
  }

 private:
  ScratchFolder folder_;
};

}  // namespace

TEST_CASE("arguments that are missing, unknown or out of range") {
  const Bench bench;
  CHECK(diagnose({}).exit_status == 1);
  CHECK(diagnose({}).errors.find("--model is required") != std::string::npos);
  CHECK(diagnose({"--help"}).exit_status == 0);
  CHECK(diagnose({"--version"}).output.starts_with("patella-diagnose "));
  bench.expectRefused({"--fast"}, {"--fast"});
  bench.expectRefused({"--holdout-fraction", "1"}, {"--holdout-fraction", "0.05"});
  bench.expectRefused({"--replicates", "5"}, {"--replicates", "299"});
  bench.expectRefused({"--nominal-tolerance", "0"}, {"--nominal-tolerance"});
  bench.expectRefused({"--person", "nan"}, {"--person: value 'nan', expected a number from 0 to 500"});
  bench.expectRefused({"--seed", "-1"}, {"--seed"});
  bench.expectRefused({"--torque", "guessed"}, {"--torque", "held", "sampled"});
  bench.expectRefused({"--holdout", bench.file("run.csv"), "--holdout-fraction", "0.2"}, {"excludes"});
  bench.expectRefused({"--effects", "coulomb_friction,stribek_friction"},
                      {"--effects: value 'stribek_friction', expected all or some of", "viscous_friction",
                       "did you mean 'stribeck_friction'?"});
}

TEST_CASE("a model that is none") {
  const Bench bench;
  bench.write("model.toml", "[mechanism]\nkind = \"revolute\"\n");
  bench.expectRefused({}, {"model.toml:1: key 'mechanism.inertia_kg_m2'"});
  bench.expectRefused({"--model", bench.file("none.toml")}, {"none.toml"});
}

TEST_CASE("a recording that is damaged") {
  const Bench bench;
  SUBCASE("not there") {
    bench.expectRefused({"--data", bench.file("none.csv")}, {"none.csv: cannot be opened"});
  }
  SUBCASE("empty") {
    bench.write("run.csv", "");
    bench.expectRefused({}, {"run.csv:1: the file is empty"});
  }
  SUBCASE("of text") {
    bench.replace("run.csv", "0.0200,", "soon,");
    bench.expectRefused({}, {"run.csv:12: column 't_s': value 'soon', expected a number"});
  }
  SUBCASE("with time that runs back") {
    bench.replace("run.csv", "\n0.0200,", "\n0.0100,");
    bench.expectRefused({}, {"run.csv:12: time 0.01 s comes after 0.018 s"});
  }
  SUBCASE("without torque") {
    bench.replace("run.csv", "tau1_Nm", "current1_A");
    bench.expectRefused({}, {"run.csv:1: there is no column 'tau1_Nm'"});
  }
  SUBCASE("of two joints") {
    bench.replace("run.csv", "t_s,q1_rad,tau1_Nm", "t_s,q2_rad,tau1_Nm");
    bench.expectRefused({}, {"run.csv:1:"});
  }
  SUBCASE("too short") {
    bench.write("run.csv", kneeCsv(0.0, 0.1));
    bench.expectRefused({}, {"run.csv: 50 complete rows, expected at least 200"});
  }
  SUBCASE("a folder that is no run") {
    std::filesystem::create_directory(bench.file("folder"));
    bench.expectRefused({"--data", bench.file("folder")}, {"folder/ticks.csv"});
  }
  SUBCASE("one of several") {
    bench.write("other.csv", "t_s\n1\n");
    bench.expectRefused({"--data", bench.file("run.csv"), bench.file("other.csv")},
                        {"other.csv:1: there is no column"});
    bench.expectRefused({"--holdout", bench.file("other.csv")}, {"other.csv:1: there is no column"});
  }
}

TEST_CASE("a log of frames with the wrong description") {
  const Bench bench;
  bench.write("run.log", "(1700000000.000000) can0 110#0000000000000000\n");
  const std::string dbc = checkout::source() / "drivers/can/patella.dbc";
  const std::vector<std::string> log{"--data", bench.file("run.log")};
  bench.expectRefused(log, {"run.log: is a log of frames", "--dbc"});
  bench.expectRefused({"--data", bench.file("run.log"), "--dbc", bench.file("none.dbc")}, {"none.dbc"});
  bench.write("broken.dbc", "BO_ 5 Broken\n");
  bench.expectRefused({"--data", bench.file("run.log"), "--dbc", bench.file("broken.dbc")}, {"broken.dbc:"});
  bench.expectRefused({"--data", bench.file("run.log"), "--dbc", dbc},
                      {"run.log: the bus map does not suit a model of one joint", "position_rad.2"});
  bench.write("model.toml", app::readFile(checkout::source() / "firmware_app/config/models/adult.toml",
                                          test::kRecordingText));
  bench.expectRefused({"--data", bench.file("run.log"), "--dbc", dbc}, {"run.log: no complete measurement"});
  bench.write("run.log", "(1700000000.000000) can0 nonsense\n");
  bench.expectRefused({"--data", bench.file("run.log"), "--dbc", dbc}, {"run.log:1:"});
}

TEST_CASE("a map of columns with a mistake") {
  const Bench bench;
  bench.write("map.toml",
              "[recording]\ntime_column = \"t_s\"\ntorque = \"held\"\nspeed = 3\n[[joint]]\n"
              "position = { column = \"q1_rad\" }\ntorque = { column = \"tau1_Nm\" }\n");
  bench.expectRefused({"--columns", bench.file("map.toml")},
                      {"map.toml:4: key 'recording.speed' is unknown"});
}

TEST_CASE("a folder for results that cannot be one") {
  const Bench bench;
  bench.expectRefused({"--out", bench.file("run.csv")}, {"run.csv: cannot be a folder for results"});
  bench.expectRefused({"--out", bench.file("run.csv/below")}, {"cannot be a folder for results"});
  bench.expectRefused({"--out", "/proc/diagnosis"},
                      {"/proc/diagnosis: cannot be a folder for results: /proc: "});
}
