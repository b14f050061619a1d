// The way around: a poor recording, its diagnosis, the motion planned from it, and the diagnosis of that.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/json_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
namespace fs = std::filesystem;

namespace {

const fs::path kConfigs = checkout::source() / "firmware_app/config";

void replace(std::string& text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  text.replace(at, old.size(), by);
}

// identification.toml with nobody pushing, so that what is left is sensors' noise.
fs::path quietRig(const fs::path& folder) {
  std::string text = app::readFile(kConfigs / "identification.toml");
  for (const char* old : {"\"models/adult.toml\"", "\"models/adult_rubbing.toml\"", "\"can/patella.toml\""}) {
    const std::string name(old);
    replace(text, name, "\"" + (kConfigs / name.substr(1, name.size() - 2)).string() + "\"");
  }
  replace(text, "kind = \"human\"\nhuman_rms_N = 1.5\nhuman_bandwidth_Hz = 1.5", "kind = \"none\"");
  app::writeFile(folder / "rig.toml", text);
  return folder / "rig.toml";
}

nlohmann::json recordedAndDiagnosed(const fs::path& rig, const fs::path& reference, const fs::path& run) {
  const test::Outcome recorded =
      test::runProgram(checkout::build() / "firmware_app/patella",
                       {"run", "--config", rig.string(), "--clock", "virtual", "--duration", "21",
                        "--reference", reference.string(), "--out", run.string()});
  CAPTURE(recorded.errors);
  REQUIRE(recorded.exit_status == 0);
  const test::Outcome diagnosed =
      test::runProgram(checkout::build() / "tools/diagnose/patella-diagnose",
                       {"--model", (kConfigs / "models/adult.toml").string(), "--data", run.string(), "--out",
                        (run / "diagnosis").string()});
  CAPTURE(diagnosed.errors);
  REQUIRE(diagnosed.exit_status == 0);
  nlohmann::json diagnosis = app::loadJson(run / "diagnosis/diagnosis.json");
  const bool poor = diagnosis["verdict"] == "insufficient_excitation";
  CHECK((diagnosed.output.find("patella-diagnose --plan") != std::string::npos) == poor);
  return diagnosis;
}

// Of the printed command, which has no word with a space.
std::vector<std::string> argumentsOf(const std::string& command, const fs::path& rig) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while (at < command.size()) {
    const std::size_t end = std::min(command.find(' ', at), command.size());
    words.push_back(command.substr(at, end - at));
    at = end + 1;
  }
  REQUIRE(words.front() == "patella-diagnose");
  words.erase(words.begin());
  std::replace(words.begin(), words.end(), std::string("CONFIG"), rig.string());
  return words;
}

// Ticks in which a limit of range, speed or torque was passed.
long brokenTicks(const fs::path& run, const app::RunConfig& config) {
  const app::CsvTable ticks = app::CsvTable::load(
      run / "ticks.csv", {.columns = {"q1_rad", "q2_rad", "dq1_rad_s", "dq2_rad_s", "tau1_Nm", "tau2_Nm"}});
  long broken = 0;
  for (std::size_t j = 0; j < 2; ++j) {
    const safety::JointLimits& limit = config.tick.limits.joint[j];
    const std::string number = std::to_string(j + 1);
    const auto q = ticks.column("q" + number + "_rad");
    const auto dq = ticks.column("dq" + number + "_rad_s");
    const auto torque = ticks.column("tau" + number + "_Nm");
    for (std::size_t i = 0; i < q.size(); ++i) {
      broken += q[i] < limit.q_min_rad || q[i] > limit.q_max_rad || std::abs(dq[i]) > limit.velocity_rad_s ||
                        std::abs(torque[i]) > limit.torque_Nm
                    ? 1
                    : 0;
    }
  }
  return broken;
}

}  // namespace

TEST_CASE("a motion that was too poor is repaired by the plan that its diagnosis asks for") {
  const test::ScratchFolder folder;
  const fs::path rig = quietRig(folder.path());
  const fs::path poor = folder.path() / "poor.toml";
  app::writeFile(
      poor,
      "blend_s = 2.0\n"
      "[[joint]]\nmotion = \"sinusoid\"\noffset_rad = -1.3\namplitude_rad = 0.1\nfrequency_Hz = 0.1\n"
      "[[joint]]\nmotion = \"sinusoid\"\noffset_rad = -0.4\namplitude_rad = 0.05\nfrequency_Hz = 0.1\n");
  const nlohmann::json before = recordedAndDiagnosed(rig, poor, folder.path() / "poor");
  CAPTURE(before["explanation"].get<std::string>());
  REQUIRE(before["verdict"] == "insufficient_excitation");

  const std::vector<std::string> arguments = argumentsOf(before["plan_command"], rig);
  const test::Outcome planned =
      test::runProgram(checkout::build() / "tools/diagnose/patella-diagnose", arguments);
  CAPTURE(planned.errors);
  REQUIRE(planned.exit_status == 0);
  CHECK(planned.output.find("coulomb friction") != std::string::npos);
  const fs::path plan = folder.path() / "poor/diagnosis/plan";
  const nlohmann::json sizes = app::loadJson(plan / "plan.json");
  for (const nlohmann::json& revealed : sizes["revealed"]) {
    CAPTURE(revealed.dump());
    CHECK(revealed["smallest_size"].is_number());
    // The rig is so quiet that any of it shows that anybody would miss.
    CHECK(revealed["share_of_torque"].get<double>() >= 0.002);
    CHECK(revealed["share_of_torque"].get<double>() < 0.003);
    CHECK(revealed["any_motion_smaller_by_at_most"].is_null());
  }
  CHECK(sizes["use_of_limits"]["position"].get<double>() <= 1.0);
  CHECK(app::readFile(plan / "plan.html").find("<svg") != std::string::npos);

  const nlohmann::json after = recordedAndDiagnosed(rig, plan / "reference.toml", folder.path() / "planned");
  CAPTURE(after["explanation"].get<std::string>());
  CHECK(after["verdict"] == "effect_found");
  std::vector<std::string> found;
  for (const nlohmann::json& effect : after["effects"]) {
    found.push_back(effect["kind"].get<std::string>() + "@" + std::to_string(effect["joint"].get<int>()));
  }
  std::sort(found.begin(), found.end());
  CHECK(found == std::vector<std::string>{"coulomb_friction@2", "linear_stiffness@2"});
  app::CommandLine line;
  line.config = rig;
  CHECK(brokenTicks(folder.path() / "planned", app::loadRunConfig(line)) == 0);
}
