// patella-diagnose --plan on arguments and files that it cannot use.
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;

namespace {

const char* const kKnee =
    "[mechanism]\nkind = \"revolute\"\ninertia_kg_m2 = 0.35\nmoment_kg_m = 1.0\nlength_m = 0.4\n";

struct Refused {
  std::vector<std::string> arguments;
  const char* because;
};

}  // namespace

TEST_CASE("wrong arguments are refused by name, and leave nothing behind") {
  const test::ScratchFolder folder;
  const std::string model = (folder.path() / "knee.toml").string();
  app::writeFile(model, kKnee);
  const std::vector<std::string> limits{"--model",    model, "--q-min",        "-2", "--q-max", "0.2",
                                        "--velocity", "4",   "--torque-limit", "30"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), limits.begin(), limits.end());
    return more;
  };
  for (const Refused& refused : std::vector<Refused>{
           {{}, "neither --config nor --model"},
           {{"--model", model}, "--q-min: not given, expected one value for each joint, or --config"},
           {{"--model", "absent.toml"}, "absent.toml"},
           {{"--config", "absent.toml"}, "absent.toml"},
           {with({"--effects", "coulomb_fricton"}), "did you mean 'coulomb_friction'?"},
           {with({"--effects", "coulomb_friction@3"}), "expected a joint from 1 to 1"},
           {with({"--effects", "all,payload"}), "'all' among others"},
           {with({"--from", "absent.json"}), "absent.json"},
           {with({"--start", "0.3,0.4"}), "--start: 2 values, expected 1"},
           {with({"--start", "0.3"}), "joint 1: the start at 0.3 rad"},
           {with({"--noise", "40"}), "less than its torque limit 30"},
           {with({"--duration", "2", "--blend", "2"}),
            "--duration: value 2 s with --blend 2 s, expected at least 3 s"},
           {with({"--duration", "4", "--blend", "2", "--harmonics", "6"}),
            "--duration: value 4 s with --blend 2 s, expected at least 8 s"},
           {with({"--duration", "2", "--blend", "5"}), "--duration: value 2 s with --blend 5 s, expected"},
           {with({"--duration", "nan"}), "--duration: value 'nan', expected a number from 2 to 600"},
           {with({"--start", "nan"}), "joint 1: the start at nan rad"},
           {{"--model", model, "--q-min", "-0.1", "--q-max", "-0.2", "--velocity", "4", "--torque-limit",
             "30"},
            "--q-min of joint 1: value -0.1, expected less than --q-max, -0.2"},
           {{"--model", model, "--q-min", "-2", "--q-max", "0.2", "--velocity", "4", "--torque-limit", "0.01",
             "--start", "-1"},
            "--torque-limit of joint 1: value 0.01 N·m, expected at least 6.63 N·m: to hold the start at -1 "
            "takes 5.3 N·m"},
           {with({"--from", model}), "is no JSON: line 1, expected the diagnosis.json of patella-diagnose"},
           {with({"--reach", "-0.1,0.1"}), "--reach: 2 values, expected 4"},
           {with({"--reach", "0.1,0.2,-0.1,0.1"}), "--reach of axis 1"},
           {with({"--torque-limit", "200,3"}), "--torque-limit"},
       }) {
    std::vector<std::string> arguments{"--plan", "--out", (folder.path() / "plan").string()};
    arguments.insert(arguments.end(), refused.arguments.begin(), refused.arguments.end());
    const test::Outcome outcome =
        test::runProgram(checkout::build() / "tools/diagnose/patella-diagnose", arguments);
    CAPTURE(refused.because);
    CAPTURE(outcome.errors);
    CHECK(outcome.exit_status == 1);
    CHECK(outcome.errors.find(refused.because) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "plan"));
  }
}

TEST_CASE("limits of the command line do without a configuration") {
  const test::ScratchFolder folder;
  app::writeFile(folder.path() / "knee.toml", kKnee);
  const test::Outcome outcome =
      test::runProgram(checkout::build() / "tools/diagnose/patella-diagnose",
                       {"--plan", "--model", (folder.path() / "knee.toml").string(), "--q-min", "-2",
                        "--q-max", "0.2", "--velocity", "4", "--torque-limit", "30", "--effects", "none",
                        "--evaluations", "200", "--out", (folder.path() / "plan").string()});
  CAPTURE(outcome.errors);
  CHECK(outcome.exit_status == 0);
  CHECK(outcome.output.find("A motion of 20 s for all base parameters.") == 0);
  CHECK(test::listing(folder.path()).contains("plan/reference.toml"));
  const std::string page = app::readFile(folder.path() / "plan" / "plan.html", files::kResultFile);
  for (const char* part :
       {"A motion of 20 s for all base parameters.", "% of the torque", "0.06 N·m",
        "patella run --config CONFIG --reference ", "limit -2 rad", "limit 0.2 rad", "limit 30 N·m"}) {
    CAPTURE(part);
    CHECK(page.find(part) != std::string::npos);
  }
}

TEST_CASE("--help has the options of a plan") {
  const test::Outcome whole =
      test::runProgram(checkout::build() / "tools/diagnose/patella-diagnose", {"--help"});
  CHECK(whole.exit_status == 0);
  CHECK(whole.output.find("--torque-limit") != std::string::npos);
  CHECK(whole.output.find("Exit status: 0 where a verdict was given, whatever it is; 1 after an error.") !=
        std::string::npos);
  const test::Outcome plan =
      test::runProgram(checkout::build() / "tools/diagnose/patella-diagnose", {"--plan", "--help"});
  CHECK(plan.exit_status == 0);
  CHECK(plan.output.find("--torque-limit") != std::string::npos);
  CHECK(plan.output.find("--holdout") == std::string::npos);
}
