// Two legs in one loop, one of which hides an effect: it is found on its joint alone, and the loop that knows
// of it moves more exactly.
#include <filesystem>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::test;
using nlohmann::json;

namespace {

const std::string kConfigurations = checkout::source() / "firmware_app/config/";
const std::string kRig = checkout::source() / "tools/studies/circle/two_legs/coulomb_right_knee.toml";
constexpr int kRightKnee = 3;

void run(const std::filesystem::path& out, std::vector<std::string> more) {
  std::vector<std::string> arguments{
      "run",         "--config", kConfigurations + "two_legs_identification.toml",
      "--rig-model", kRig,       "--clock",
      "virtual",     "--out",    out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = runProgram(checkout::build() / "firmware_app/patella", arguments);
  INFO(outcome.errors);
  REQUIRE(outcome.exit_status == 0);
}

json numbersOf(const std::filesystem::path& file) {
  return json::parse(app::readFile(file, test::kRecordingText));
}

}  // namespace

TEST_CASE(
    "dry friction in the right knee of two legs is found there, and the loop that knows of it tracks "
    "better") {
  const ScratchFolder folder;
  run(folder / "recorded", {"--duration", "25"});
  const Outcome diagnosed = runProgram(
      checkout::build() / "tools/diagnose/patella-diagnose",
      {"--model", kConfigurations + "models/two_legs.toml", "--data", (folder / "recorded").string(), "--out",
       (folder / "diagnosis").string(), "--replicates", "299"});
  INFO(diagnosed.errors);
  REQUIRE(diagnosed.exit_status == 0);

  const json diagnosis = numbersOf(folder / "diagnosis/diagnosis.json");
  CHECK(diagnosis["verdict"] == "effect_found");
  REQUIRE_FALSE(diagnosis["effects"].empty());
  // With next to no noise a second friction may bend the first one's turning round to the rig's.
  double level_Nm = 0.0;
  for (const json& effect : diagnosis["effects"]) {
    CHECK(effect["kind"] == "coulomb_friction");
    CHECK(effect["joint"] == kRightKnee + 1);
    level_Nm += effect["parameters"]["level_Nm"].get<double>();
  }
  CHECK(level_Nm == doctest::Approx(2.0).epsilon(0.05));

  const std::vector<std::string> unseen{
      "--reference", kConfigurations + "references/two_legs_unseen.toml", "--seed", "2", "--duration", "10"};
  run(folder / "plain", unseen);
  std::vector<std::string> informed = unseen;
  informed.insert(informed.end(), {"--model", (folder / "diagnosis/model.extended.toml").string()});
  run(folder / "extended", informed);
  const json plain = numbersOf(folder / "plain/summary.json");
  const json extended = numbersOf(folder / "extended/summary.json");
  const auto of = [](const json& summary, const char* what, int joint) {
    return summary[what][joint].get<double>();
  };
  CHECK(of(extended, "tracking_rms_rad", kRightKnee) < 0.6 * of(plain, "tracking_rms_rad", kRightKnee));
  CHECK(of(extended, "d_hat_rms_Nm", kRightKnee) < 0.3 * of(plain, "d_hat_rms_Nm", kRightKnee));
  for (int joint = 0; joint < kRightKnee; ++joint) {
    CAPTURE(joint);
    CHECK(of(extended, "tracking_rms_rad", joint) < 1.05 * of(plain, "tracking_rms_rad", joint));
  }
}
