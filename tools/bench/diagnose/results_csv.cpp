#include <fmt/format.h>

#include "drivers/joined.hpp"
#include "tools/bench/diagnose/summary.hpp"

namespace patella::bench {
namespace {

std::string values(const std::vector<double>& numbers) {
  return joined(numbers, ";", [](double value) { return fmt::format("{:.4g}", value); });
}

std::string trueParameters(const CaseEffect& effect) {
  const KindInfo& info = effect.effect.info();
  std::string text;
  for (std::size_t i = 0; i < kMaxParameters && !info.parameters[i].empty(); ++i) {
    text += fmt::format("{}{}={:.5g}", i == 0 ? "" : " ", info.parameters[i], effect.effect.p[i]);
  }
  return text;
}

std::string foundParameters(const diagnose::EffectFinding& finding) {
  return joined(finding.parameters, ";", [](const diagnose::ParameterEstimate& p) {
    return fmt::format("{}={:.5g} [{:.5g} {:.5g}]", p.name, p.value, p.ci95[0], p.ci95[1]);
  });
}

// Commas separate cells, and none of these texts needs one.
std::string cell(std::string text) {
  for (char& c : text) {
    c = c == ',' || c == '\n' || c == '"' ? ' ' : c;
  }
  return text;
}

}  // namespace

std::string csvHeader() {
  return "seed,suite,mechanism,joints,motion,duration_s,truth,truth_parameters,strength,raw_strength,in_span,"
         "verdict,"
         "found,found_parameters,p_value,gain_nats,set,outcome,named_right,false_findings,unexplained,"
         "right_variable,true_noise_Nm,noise_floor_Nm,heldout_before_Nm,heldout_refitted_Nm,heldout_after_Nm,"
         "heldout_before_noise,heldout_after_noise,simulating_s,diagnosing_s,processor_s,error\n";
}

std::string csvRow(const CaseResult& one) {
  const diagnose::Diagnosis& d = one.diagnosis;
  const bool failed = !one.error.empty();
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.4g}", *value) : std::string();
  };
  std::vector<std::string> cells{
      std::to_string(one.seed),
      std::string(suiteName(one.suite)),
      one.mechanism,
      std::to_string(one.joints),
      one.motion,
      fmt::format("{:.1f}", one.duration_s),
      joined(one.effects, ";", [](const CaseEffect& e) { return e.effect.label(); }),
      joined(one.effects, ";", trueParameters),
      joined(one.effects, ";", [](const CaseEffect& e) { return fmt::format("{:.3f}", e.strength); }),
      joined(one.effects, ";", [](const CaseEffect& e) { return fmt::format("{:.3f}", e.raw_strength); }),
      one.truth.in_span ? "1" : "0",
      failed ? "" : std::string(diagnose::verdictName(d.verdict)),
      joined(d.effects, ";", [](const auto& f) { return f.kind + "@" + std::to_string(f.joint + 1); }),
      joined(d.effects, ";", foundParameters),
      joined(d.effects, ";",
             [](const auto& f) { return f.p_value ? fmt::format("{:.3g}", *f.p_value) : ""; }),
      joined(d.effects, ";", [](const auto& f) { return fmt::format("{:.3g}", f.gain); }),
      joined(d.effects, ";",
             [](const auto& f) { return fmt::format("{{{}}}", fmt::join(f.indistinguishable_from, " ")); }),
      failed ? "" : std::string(outcomeName(one.score.outcome)),
      one.score.named_right ? "1" : "0",
      std::to_string(one.score.false_findings),
      joined(
          d.unexplained, ";",
          [](const auto& u) { return fmt::format("{}→{} {:.3g}", u.variable, u.joint + 1, u.explained_Nm); }),
      one.score.right_variable ? (*one.score.right_variable ? "1" : "0") : "",
      values(one.truth.heldout_noise_Nm),
      values(d.noise_floor_Nm),
      values(d.before.heldout_rms_Nm),
      values(d.refitted.heldout_rms_Nm),
      values(d.after.heldout_rms_Nm),
      number(one.score.heldout_before),
      number(one.score.heldout_after),
      fmt::format("{:.2f}", one.simulating_s),
      fmt::format("{:.2f}", one.diagnosing_s),
      fmt::format("{:.2f}", one.processor_s),
      one.error};
  return joined(cells, ",", cell) + "\n";
}

}  // namespace patella::bench
