#include "tools/diagnose/output/diagnosis_json.hpp"

#include <Eigen/Core>
#include <fmt/format.h>

#include "tools/diagnose/output/revealed_json.hpp"
#include "tools/diagnose/result/parameter_text.hpp"

namespace patella::diagnose {
namespace {

using Json = nlohmann::ordered_json;

/// [] rather than null for an empty list.
template <typename Items, typename Describe>
Json list(const Items& items, Describe&& describe) {
  Json out = Json::array();
  for (const auto& item : items) {
    out.push_back(describe(item));
  }
  return out;
}

Json numberOrNull(const std::optional<double>& number) {
  return number ? Json(*number) : Json();
}

Json describeEffect(const EffectFinding& effect) {
  Json parameters = Json::object();
  Json intervals = Json::object();
  for (const ParameterEstimate& parameter : effect.parameters) {
    parameters[parameter.name] = parameter.value;
    intervals[parameter.name] = parameter.ci95;
  }
  return {{"kind", effect.kind},
          {"joint", effect.joint + 1},
          {"parameters", parameters},
          {"ci95", intervals},
          {"torque_error", numberOrNull(effect.torque_error)},
          {"p_value", numberOrNull(effect.p_value)},
          {"gain_nats", effect.gain},
          {"indistinguishable_from", effect.indistinguishable_from},
          {"replaces", effect.replaces},
          {"separating_motion", effect.separating_motion},
          {"asserted", effect.asserted()},
          {"not_asserted_because", effect.not_asserted_because}};
}

Json describeError(const ErrorMeasure& error) {
  return {{"train_rms", error.train_rms_Nm},
          {"heldout_rms", error.heldout_rms_Nm},
          {"train_relative", error.train_relative},
          {"heldout_relative", error.heldout_relative}};
}

Json describeStep(const SelectionStep& step) {
  return {{"accepted", step.accepted.empty() ? Json() : Json(step.accepted)},
          {"p_value", step.p_value},
          {"ranking", list(step.ranking, [](const CandidateScore& score) -> Json {
             return {{"label", score.label},
                     {"gain_nats", score.gain},
                     {"threshold_nats", score.threshold},
                     {"accepted", score.accepted},
                     {"refused_because", score.refused_because}};
           })}};
}

Json describeExcitation(const Excitation& excitation) {
  return {{"position_range_rad", excitation.position_range_rad},
          {"velocity_rms_rad_s", excitation.velocity_rms_rad_s},
          {"identifiable", excitation.identifiable},
          {"not_identifiable", excitation.not_identifiable}};
}

Json describeUnexplained(const Dependence& dependence) {
  return {{"joint", dependence.joint + 1},
          {"variable", dependence.variable},
          {"explained_rms", dependence.explained_Nm},
          {"p_value", numberOrNull(dependence.p_value)}};
}

Json describeNominal(const RefittedParameter& parameter) {
  Json json{{"name", parameter.name},
            {"nominal", parameter.nominal},
            {"refitted", parameter.refitted},
            {"sd", parameter.sd}};
  if (!parameter.made_of.empty()) {
    json["combination"] = parameter.made_of;
  }
  return json;
}

Json describeRunaway(const Runaway& runaway) {
  return {{"what", runaway.what},
          {"nominal", runaway.nominal},
          {"refitted", runaway.refitted},
          {"limit", runaway.limit},
          {"words", runaway.words}};
}

Json describeTiming(const DriveTiming& timing) {
  return {{"joint", timing.joint + 1},
          {"delay_s", timing.delay_s},
          {"lag_s", timing.lag_s},
          {"relative_error_before", timing.relative_error_before},
          {"relative_error_after", timing.relative_error_after}};
}

Json unitsOfJoints(const Diagnosis& diagnosis, std::string Units::*of) {
  Json units = Json::array();
  for (int joint = 0; joint < diagnosis.extended.joints(); ++joint) {
    units.push_back(unitsOf(diagnosis, joint).*of);
  }
  return units;
}

Json versions() {
  return {{"patella", PATELLA_VERSION},
          {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"ceres", PATELLA_CERES_VERSION}};
}

}  // namespace

nlohmann::ordered_json diagnosisJson(const Diagnosis& diagnosis) {
  Json out;
  out["verdict"] = verdictName(diagnosis.verdict);
  out["explanation"] = diagnosis.explanation;
  out["doubts"] = list(diagnosis.doubts, [](const Doubt& doubt) -> Json {
    return {{"kind", doubtName(doubt.kind)}, {"words", doubt.words}};
  });
  out["effects"] = list(diagnosis.effects, describeEffect);
  out["error"] = {{"before", describeError(diagnosis.before)},
                  {"refitted", describeError(diagnosis.refitted)},
                  {"after", describeError(diagnosis.after)},
                  {"noise_floor", diagnosis.noise_floor_Nm},
                  {"units", unitsOfJoints(diagnosis, &Units::torque)}};
  out["rest"] = list(diagnosis.rests, [](const RestOfJoint& rest) -> Json {
    return {{"torque", rest.torque_Nm}, {"beyond_noise", rest.structure_Nm}, {"noise", rest.noise_Nm}};
  });
  out["simulation_error"] = {{"window_s", diagnosis.simulation_window_s},
                             {"before", diagnosis.before.simulation_rms_rad},
                             {"after", diagnosis.after.simulation_rms_rad},
                             {"units", unitsOfJoints(diagnosis, &Units::position)}};
  out["excitation"] = describeExcitation(diagnosis.excitation);
  out["plan_command"] = diagnosis.plan_command.empty() ? Json() : Json(diagnosis.plan_command);
  out["revealed"] = list(diagnosis.revealed, describeRevealed);
  out["unexplained"] = list(diagnosis.unexplained, describeUnexplained);
  out["nominal_parameters"] = list(diagnosis.nominal, describeNominal);
  out["correlations"] = {{"parameters", diagnosis.correlations.parameters},
                         {"matrix", diagnosis.correlations.matrix}};
  out["runaways"] = list(diagnosis.runaways, describeRunaway);
  out["drive_timing"] = list(diagnosis.drive_timing, describeTiming);
  out["steps"] = list(diagnosis.steps, describeStep);
  out["warnings"] = diagnosis.warnings;
  out["seed"] = diagnosis.seed;
  out["inputs"] = list(diagnosis.inputs, [](const InputFile& input) -> Json {
    return {{"path", input.path}, {"sha256", input.sha256}};
  });
  out["versions"] = versions();
  return out;
}

std::string diagnosisText(const Diagnosis& diagnosis) {
  return diagnosisJson(diagnosis).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace patella::diagnose
