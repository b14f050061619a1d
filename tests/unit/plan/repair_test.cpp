#include "tools/diagnose/plan/repair.hpp"

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/file_error.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::diagnose;

using Names = std::vector<std::string>;

TEST_CASE("what was found in doubt is shown, and what is commonly missing and was not told") {
  CHECK(effectsToShow({"coulomb_friction@2"},
                      {"viscous_friction@1", "payload@1", "actuator_lag@1", "nominal mass_kg[1]"},
                      2) == Names{"coulomb_friction@2", "viscous_friction@1"});
  CHECK(effectsToShow({}, {"actuator_lag@1", "backlash@1"}, 1) == Names{"actuator_lag@1"});
}

TEST_CASE("a joint at rest, or a recording that tells nothing, asks for what is commonly missing") {
  const Names of_two{"coulomb_friction@2", "viscous_friction@2", "linear_stiffness@2", "torque_bias@2"};
  CHECK(effectsToShow({}, {"joint 2 is at rest"}, 2) == of_two);
  CHECK(effectsToShow({}, {}, 2).size() == 8);
}

TEST_CASE("a diagnosis that could tell has no plan, another one the whole command") {
  Diagnosis diagnosis;
  diagnosis.excitation.position_range_rad = {0.1};
  diagnosis.excitation.not_identifiable = {"viscous_friction@1"};
  CHECK(planCommandLine(diagnosis, "knee.toml", "out").empty());
  diagnosis.verdict = Verdict::kInsufficientExcitation;
  CHECK(planCommandLine(diagnosis, "my knee.toml", "out") ==
        "patella-diagnose --plan --config CONFIG --model 'my knee.toml' --from out/diagnosis.json --effects "
        "viscous_friction@1 --out out/plan");
}

TEST_CASE("a plan reads effects and noise of a diagnosis") {
  const test::ScratchFolder folder;
  const std::filesystem::path file = folder / "diagnosis.json";
  app::writeFile(file, R"({"effects": [{"kind": "coulomb_friction", "joint": 1}],
    "excitation": {"position_range_rad": [0.1], "not_identifiable": ["torque_bias@1"]},
    "rest": [{"torque": 3.0, "beyond_noise": 0.2, "noise": 0.1}]})");
  const Unrevealed unrevealed = readUnrevealed(file, 1);
  CHECK(unrevealed.effects == Names{"coulomb_friction@1", "torque_bias@1"});
  REQUIRE(unrevealed.noise.size() == 1);
  CHECK(unrevealed.noise[0].noise_Nm == 0.1);
  CHECK(unrevealed.noise[0].structure_Nm == 0.2);
  CHECK_THROWS_AS(readUnrevealed(file, 2), app::FileError);
  app::writeFile(file, R"({"summary": 1})");
  CHECK_THROWS_AS(readUnrevealed(file, 1), app::FileError);
  app::writeFile(file, R"({"effects": [], "excitation": {"position_range_rad": [0.1]}, "rest": []})");
  CHECK_THROWS_AS(readUnrevealed(file, 1), app::FileError);
  CHECK_THROWS_AS(readUnrevealed(folder / "absent.json", 1), app::FileError);
}

TEST_CASE("a file that is no JSON is refused by its line") {
  const test::ScratchFolder folder;
  const std::filesystem::path file = folder / "report.html";
  const auto refusal = [&](const char* text) {
    app::writeFile(file, text);
    const std::string message = test::messageOf<app::FileError>([&] { readUnrevealed(file, 1); });
    return message.substr(std::min(message.find("report.html"), message.size()));
  };
  CHECK(refusal("<html>\n") ==
        "report.html: is no JSON: line 1, expected the diagnosis.json of patella-diagnose");
  CHECK(refusal("{\"effects\": [],\n\"rest\" 1}").starts_with("report.html: is no JSON: line 2,"));
  CHECK(refusal("{\"effects\": 1e999}").starts_with("report.html: is no JSON, expected"));
  CHECK(refusal("").starts_with("report.html: is no JSON: line 1,"));
}

TEST_CASE("the command that runs a plan can be typed as it is") {
  CHECK(runCommandLine("my rig.toml", "out/plan") ==
        "patella run --config 'my rig.toml' --reference out/plan/reference.toml");
  CHECK(runCommandLine({}, "plan") == "patella run --config CONFIG --reference plan/reference.toml");
}
