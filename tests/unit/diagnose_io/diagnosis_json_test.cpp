// The file that programs read.
#include "tools/diagnose/output/diagnosis_json.hpp"

#include <doctest/doctest.h>

#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

using namespace patella;
using nlohmann::json;

namespace {

json written() {
  return json::parse(diagnose::diagnosisText(test::madeUpDiagnosis()));
}

}  // namespace

TEST_CASE("every key is there, in the promised order") {
  std::vector<std::string> keys;
  const nlohmann::ordered_json out = diagnose::diagnosisJson(test::madeUpDiagnosis());
  for (const auto& [key, value] : out.items()) {
    keys.push_back(key);
  }
  CHECK(keys == std::vector<std::string>{
                    "verdict",     "explanation",        "doubts",       "effects",      "error",
                    "rest",        "simulation_error",   "excitation",   "plan_command", "revealed",
                    "unexplained", "nominal_parameters", "correlations", "runaways",     "drive_timing",
                    "steps",       "warnings",           "seed",         "inputs",       "versions"});
}

TEST_CASE("an effect has its parameters by name, and counts joints from 1") {
  const json out = written();
  CHECK(out["verdict"] == "effect_found");
  REQUIRE(out["effects"].size() == 2);
  const json& effect = out["effects"][1];
  CHECK(effect["kind"] == "coulomb_friction");
  CHECK(effect["joint"] == 2);
  CHECK(effect["parameters"] == json{{"level_Nm", 1.48}});
  CHECK(effect["ci95"]["level_Nm"] == json{1.42, 1.54});
  CHECK(effect["p_value"] == 0.002);
  CHECK(effect["gain_nats"] == 880.0);
  CHECK(effect["replaces"] == json{"viscous_friction"});
  CHECK(effect["indistinguishable_from"] == json{"presliding_hysteresis", "viscous_friction@1+torque_bias"});
  CHECK(effect["separating_motion"] == "slow reversals of less than 0.05 rad");
}

TEST_CASE("a smallest size has the whole effect that it belongs to") {
  const json out = written();
  REQUIRE(out["revealed"].size() == 1);
  CHECK(out["revealed"][0]["smallest_size"] == 0.8);
  CHECK(out["revealed"][0]["parameters"] == json{{"mass_kg", 0.8}, {"distance_m", 0.3}});
}

TEST_CASE("errors before and after, with their unit; what is no number is null") {
  const json out = written();
  CHECK(out["error"]["before"]["train_rms"] == json{0.21, 2.31});
  CHECK(out["error"]["refitted"]["heldout_rms"] == json{0.21, 1.3});
  CHECK(out["error"]["after"]["heldout_relative"] == json{0.01, 0.008});
  CHECK(out["error"]["after"]["train_relative"] == json{0.01, 0.007});
  CHECK(out["error"]["noise_floor"] == json{0.19, 0.05});
  CHECK(out["error"]["units"] == json{"N·m", "N·m"});
  CHECK(out["simulation_error"]["window_s"] == 0.5);
  CHECK(out["simulation_error"]["before"] == json{0.002, 0.31});
  CHECK(out["simulation_error"]["after"][0] == 0.002);
  CHECK(out["simulation_error"]["after"][1].is_null());
  CHECK(out["simulation_error"]["units"] == json{"rad", "rad"});
}

TEST_CASE("the way to the answer is told") {
  const json out = written();
  CHECK(out["unexplained"][0] ==
        json{{"joint", 1}, {"variable", "ddq1*q1"}, {"explained_rms", 0.02}, {"p_value", 0.02}});
  CHECK(out["nominal_parameters"][0]["name"] == "mass_kg.1");
  CHECK(out["nominal_parameters"][0]["refitted"] == 7.31);
  CHECK(out["drive_timing"][0]["joint"] == 2);
  CHECK(out["drive_timing"][0]["lag_s"] == 0.008);
  CHECK(out["excitation"]["not_identifiable"] == json{"torque_gain@1"});
  REQUIRE(out["steps"].size() == 3);
  CHECK(out["steps"][0]["accepted"] == "linear_stiffness@2");
  CHECK(out["steps"][0]["ranking"][3]["refused_because"] == "sign: level_Nm");
  CHECK(out["steps"][2]["accepted"].is_null());
  CHECK(out["seed"] == 7);
  CHECK(out["inputs"][0]["sha256"] == "12ab");
  for (const char* part : {"patella", "eigen", "ceres"}) {
    CHECK(out["versions"][part].get<std::string>().find('.') != std::string::npos);
  }
}

TEST_CASE("what to look at twice is plain data, as are correlations") {
  const json out = written();
  REQUIRE(out["runaways"].size() == 2);
  CHECK(out["runaways"][0]["what"] == "coulomb_friction@2 level_Nm");
  CHECK(out["runaways"][0]["nominal"].is_null());
  CHECK(out["runaways"][0]["refitted"] == 1.48);
  CHECK(out["runaways"][1]["limit"] == 0.01);
  CHECK(out["runaways"][1]["words"] == "the model's mass left its tolerance");
  CHECK(out["correlations"]["parameters"][1] == "linear_stiffness@2 stiffness_Nm_rad");
  CHECK(out["correlations"]["matrix"][1] == json{0.95, 1.0, -0.3});
}

TEST_CASE("an empty diagnosis has empty lists, and any bytes may be in a path") {
  diagnose::Diagnosis nothing;
  nothing.inputs = {{.path = "f\xffle.csv", .sha256 = ""}};
  const json out = json::parse(diagnose::diagnosisText(nothing));
  for (const char* key :
       {"effects", "unexplained", "nominal_parameters", "runaways", "drive_timing", "steps", "warnings"}) {
    CAPTURE(key);
    CHECK(out[key].is_array());
    CHECK(out[key].empty());
  }
  CHECK(out["inputs"][0]["path"] == "f\uFFFDle.csv");
}
