// Files that a diagnosis leaves behind.
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tests/integration/diagnose/diagnose_process.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::test;
using nlohmann::json;

TEST_CASE("a knee that rubs: page, numbers and a model that loads; the same again from the same seed") {
  const ScratchFolder folder;
  app::writeFile(folder / "model.toml", kneeModel());
  app::writeFile(folder / "run.csv", kneeCsv(1.5, 20.0));
  const auto run = [&](const char* out) {
    return diagnose({"--model", (folder / "model.toml").string(), "--data", (folder / "run.csv").string(),
                     "--out", (folder / out).string(), "--replicates", "299", "--seed", "5"});
  };
  const Outcome outcome = run("out/a");
  INFO(outcome.errors);
  REQUIRE(outcome.exit_status == 0);
  CHECK(outcome.output.find("coulomb friction on joint 1: level 1.") != std::string::npos);
  CHECK(outcome.output.find("files in ") != std::string::npos);
  CHECK(listing(folder / "out/a") ==
        std::set<std::string>{"diagnosis.json", "model.extended.toml", "report.html"});

  const json numbers = json::parse(app::readFile(folder / "out/a/diagnosis.json", test::kRecordingText));
  CHECK(numbers["verdict"] == "effect_found");
  REQUIRE(numbers["effects"].size() == 1);
  CHECK(numbers["effects"][0]["kind"] == "coulomb_friction");
  CHECK(numbers["effects"][0]["parameters"]["level_Nm"].get<double>() == doctest::Approx(1.5).epsilon(0.05));
  CHECK(numbers["inputs"][0]["sha256"] == app::fileSha256(folder / "run.csv"));
  CHECK(numbers["error"]["after"]["heldout_rms"][0].get<double>() <
        0.2 * numbers["error"]["before"]["heldout_rms"][0].get<double>());

  const model::ModelDescription extended = app::loadModel(folder / "out/a/model.extended.toml");
  REQUIRE(extended.effects.size() == 1);
  CHECK(extended.effects[0].kind == "coulomb_friction");
  CHECK(app::readFile(folder / "out/a/model.extended.toml", test::kRecordingText).find("run.csv (SHA-256 ") !=
        std::string::npos);

  REQUIRE(run("out/b").exit_status == 0);
  for (const char* file : {"diagnosis.json", "model.extended.toml", "report.html"}) {
    CAPTURE(file);
    const bool identical = app::readFile(folder / "out/a" / file, test::kRecordingText) ==
                           app::readFile(folder / "out/b" / file, test::kRecordingText);
    CHECK(identical);
  }
}

TEST_CASE("a run of the loop, from its folder and from its log") {
  const ScratchFolder folder;
  const std::string config = checkout::source() / "firmware_app/config/adult.toml";
  const Outcome loop = runProgram(checkout::build() / "firmware_app/patella",
                                  {"run", "--config", config, "--clock", "virtual", "--duration", "9",
                                   "--out", (folder / "run").string()});
  INFO(loop.errors);
  REQUIRE(loop.exit_status == 0);
  const auto errors = [&](const std::vector<std::string>& data, const char* out) {
    std::vector<std::string> arguments{
        "--model",      checkout::source() / "firmware_app/config/models/adult.toml",
        "--out",        (folder / out).string(),
        "--replicates", "299",
        "--effects",    "coulomb_friction,linear_stiffness",
        "--data"};
    arguments.insert(arguments.end(), data.begin(), data.end());
    const Outcome outcome = diagnose(arguments);
    INFO(outcome.errors);
    REQUIRE(outcome.exit_status == 0);
    return json::parse(
        app::readFile(folder / out / "diagnosis.json", test::kRecordingText))["error"]["before"]["train_rms"];
  };
  const json from_table = errors({(folder / "run").string()}, "table");
  const json from_log = errors(
      {(folder / "run/frames.log").string(), "--dbc", checkout::source() / "drivers/can/patella.dbc"}, "log");
  for (std::size_t joint = 0; joint < 2; ++joint) {
    CHECK(from_log[joint].get<double>() == doctest::Approx(from_table[joint].get<double>()).epsilon(0.01));
  }
}
