#include "tools/bench/diagnose/score.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::bench {
namespace {

using diagnose::Diagnosis;
using diagnose::EffectFinding;
using diagnose::Verdict;

const diagnose::ParameterEstimate* parameterOf(const EffectFinding& finding, std::string_view name) {
  const auto found = std::find_if(finding.parameters.begin(), finding.parameters.end(),
                                  [name](const auto& parameter) { return parameter.name == name; });
  return found == finding.parameters.end() ? nullptr : &*found;
}

bool otherChannel(const EffectFinding& finding, const TrueFinding& truth) {
  const diagnose::ParameterEstimate* channel = parameterOf(finding, "channel");
  return truth.emg_channel > 0 && channel != nullptr && std::lround(channel->value) != truth.emg_channel;
}

// Which true effects an alternative consists of, as bits; nothing where a part of it is not true.
std::optional<unsigned> trueParts(const EffectFinding& finding, const std::vector<Part>& alternative,
                                  const Truth& truth) {
  unsigned bits = 0;
  for (const Part& part : alternative) {
    const auto found = std::find_if(
        truth.effects.begin(), truth.effects.end(),
        [&](const TrueFinding& effect) { return effect.kind == part.kind && effect.joint == part.joint; });
    if (found == truth.effects.end() || (finding.kind == part.kind && otherChannel(finding, *found))) {
      return std::nullopt;
    }
    bits |= 1U << static_cast<unsigned>(found - truth.effects.begin());
  }
  return bits;
}

/// True effects as bits: by their own kinds, and as what a finding could be instead.
struct Named {
  unsigned own = 0;
  unsigned instead = 0;
};

// Whether the findings from `index` on can be taken so that all true effects are named, each once. Findings
// that may all be one effect instead, such as dry and viscous friction of a joint, name it together.
bool canNameAll(const Diagnosis& diagnosis, const Truth& truth, std::size_t index, Named named) {
  if (index == diagnosis.effects.size()) {
    return (named.own | named.instead) + 1U == 1U << truth.effects.size();
  }
  const EffectFinding& finding = diagnosis.effects[index];
  const auto all = alternatives(finding);
  for (std::size_t a = 0; a < all.size(); ++a) {
    const std::optional<unsigned> bits = trueParts(finding, all[a], truth);
    Named with = named;
    (a == 0 ? with.own : with.instead) |= bits.value_or(0);
    const unsigned taken = a == 0 ? named.own | named.instead : named.own;
    if (bits && (*bits & taken) == 0 && canNameAll(diagnosis, truth, index + 1, with)) {
      return true;
    }
  }
  return false;
}

bool isFalse(const EffectFinding& finding, const Truth& truth) {
  const auto all = alternatives(finding);
  return std::none_of(all.begin(), all.end(), [&](const auto& alternative) {
    return trueParts(finding, alternative, truth).has_value();
  });
}

// The variables in "ddq1*q2".
std::vector<std::string> factors(const std::string& variable) {
  std::vector<std::string> names;
  std::istringstream text(variable);
  for (std::string name; std::getline(text, name, '*');) {
    names.push_back(name);
  }
  return names;
}

bool namesVariable(const Diagnosis& diagnosis, const Truth& truth) {
  if (diagnosis.unexplained.empty()) {
    return false;
  }
  const std::vector<std::string> named = factors(diagnosis.unexplained.front().variable);
  return std::any_of(named.begin(), named.end(), [&](const std::string& name) {
    return std::find(truth.variables.begin(), truth.variables.end(), name) != truth.variables.end();
  });
}

std::optional<double> inNoise(const std::vector<double>& rms_Nm, const std::vector<double>& noise_Nm) {
  if (rms_Nm.empty() || rms_Nm.size() != noise_Nm.size()) {
    return std::nullopt;
  }
  double sum = 0.0;
  for (std::size_t j = 0; j < rms_Nm.size(); ++j) {
    sum += (rms_Nm[j] / noise_Nm[j]) * (rms_Nm[j] / noise_Nm[j]);
  }
  return std::sqrt(sum / static_cast<double>(rms_Nm.size()));
}

Outcome outcomeOf(const Truth& truth, const Diagnosis& diagnosis, const Score& score) {
  const bool unknown = diagnosis.verdict == Verdict::kUnknownEffect;
  if (diagnosis.verdict == Verdict::kInsufficientExcitation) {
    return Outcome::kAbstained;
  }
  if ((truth.suite == Suite::kUnknown || truth.suite == Suite::kDefect) && unknown) {
    return Outcome::kRight;
  }
  if (unknown) {
    return Outcome::kUnknown;
  }
  if (score.false_findings > 0) {
    return Outcome::kFalse;
  }
  if (diagnosis.effects.empty()) {
    return truth.suite == Suite::kNone ? Outcome::kRight : Outcome::kNothing;
  }
  if (!canNameAll(diagnosis, truth, 0, {})) {
    return Outcome::kPartly;
  }
  return score.largest_set == 1   ? Outcome::kExact
         : score.largest_set == 2 ? Outcome::kPair
                                  : Outcome::kLargerSet;
}

// A finding of dry friction alone leaves damping to the effect that the model declares for it.
bool keptByDeclared(const Diagnosis& diagnosis, const EffectFinding& finding,
                    const diagnose::ParameterEstimate& estimate) {
  return estimate.ci95[0] == estimate.ci95[1] && estimate.name.ends_with("_Nms_rad") &&
         std::any_of(diagnosis.extended.effects.begin(), diagnosis.extended.effects.end(),
                     [&](const model::EffectDescription& effect) {
                       return effect.kind == "viscous_friction" && effect.joint == finding.joint;
                     });
}

void compareParameters(const Truth& truth, const Diagnosis& diagnosis, Score& score) {
  for (const TrueFinding& effect : truth.effects) {
    for (const EffectFinding& finding : diagnosis.effects) {
      if (finding.kind != effect.kind || finding.joint != effect.joint || otherChannel(finding, effect)) {
        continue;
      }
      for (const NamedValue& parameter : effect.parameters) {
        const auto* estimate = parameterOf(finding, parameter.name);
        if (estimate != nullptr && !keptByDeclared(diagnosis, finding, *estimate)) {
          score.parameters.push_back({.name = effect.kind + "." + parameter.name,
                                      .truth = parameter.value,
                                      .estimate = estimate->value,
                                      .ci95 = estimate->ci95});
        }
      }
    }
  }
}

// "q dq other_q" of a joint to "q1", "dq1", "q2".
std::vector<std::string> variablesOf(const TrueEffect& effect) {
  std::vector<std::string> result;
  std::istringstream text{std::string(effect.info().variables)};
  const std::string joint = std::to_string(effect.joint + 1);
  for (std::string name; text >> name;) {
    if (name == "time") {
      result.push_back(name);
    } else if (name == "other_q") {
      result.push_back("q" + std::to_string(2 - effect.joint));
    } else if (name == "activation") {
      const bool torque = effect.kind == Kind::kEmg;
      result.push_back("activation" + std::to_string(std::lround(torque ? effect.p[1] : effect.p[2])));
    } else {
      result.push_back(name + joint);
    }
  }
  return result;
}

TrueFinding findingOf(const TrueEffect& effect) {
  const KindInfo& info = effect.info();
  TrueFinding result{
      .kind = std::string(info.name), .joint = static_cast<int>(effect.joint), .parameters = {}};
  const bool wandering = effect.kind == Kind::kTremor && effect.p[3] > 0.0;
  for (std::size_t i = 0; i < kMaxParameters; ++i) {
    // A tremor whose phase wanders has a frequency, but no amplitude at one frequency.
    const bool compared = (info.compared >> i & 1U) != 0 && effect.p[i] != 0.0 && !(wandering && i == 0);
    if (compared) {
      result.parameters.push_back({.name = std::string(info.parameters[i]), .value = effect.p[i]});
    }
  }
  if (effect.kind == Kind::kEmg) {
    result.emg_channel = static_cast<int>(std::lround(effect.p[1]));
  }
  return result;
}

// A finding of viscous friction takes the place of the damping that the model declares, so that it holds
// both.
template <typename Damping>
void addDeclared(const Damping& damping_Nms_rad, TrueFinding& finding) {
  for (NamedValue& parameter : finding.parameters) {
    const bool viscous = (finding.kind == "viscous_friction" || finding.kind == "asymmetric_friction") &&
                         parameter.name.ends_with("_Nms_rad");
    parameter.value += viscous ? damping_Nms_rad[static_cast<std::size_t>(finding.joint)] : 0.0;
  }
}

}  // namespace

std::string_view outcomeName(Outcome outcome) noexcept {
  constexpr std::array<std::string_view, 10> kNames{"exact",   "pair",    "larger_set", "partly", "false",
                                                    "nothing", "unknown", "abstained",  "right",  "failed"};
  return kNames[static_cast<std::size_t>(outcome)];
}

double ParameterScore::relativeError() const noexcept {
  return std::abs(estimate - truth) / std::abs(truth);
}

std::vector<std::vector<Part>> alternatives(const EffectFinding& finding) {
  std::vector<std::vector<Part>> result{{{.kind = finding.kind, .joint = finding.joint}}};
  for (const std::string& entry : finding.indistinguishable_from) {
    std::vector<Part> parts;
    std::istringstream text(entry);
    for (std::string kind; std::getline(text, kind, '+');) {
      const std::size_t at = kind.find('@');
      const int joint = at == std::string::npos ? finding.joint : std::stoi(kind.substr(at + 1)) - 1;
      parts.push_back({.kind = kind.substr(0, at), .joint = joint});
    }
    result.push_back(std::move(parts));
  }
  return result;
}

Truth truthOf(const Case& drawn) {
  Truth truth;
  truth.suite = drawn.suite;
  for (const CaseEffect& effect : drawn.effects) {
    truth.effects.push_back(findingOf(effect.effect));
    addDeclared(drawn.rig.body.damping_Nms_rad, truth.effects.back());
    const std::vector<std::string> names = variablesOf(effect.effect);
    truth.variables.insert(truth.variables.end(), names.begin(), names.end());
    truth.in_span = truth.in_span || effect.in_span;
  }
  const Analysis analysis = analyse(drawn.rig, drawn.run, diagnose::DatasetOptions{}.band_Hz);
  const PerJoint noise_Nm = heldoutNoise_Nm(analysis, diagnose::DiagnoseOptions{}.holdout_fraction);
  truth.heldout_noise_Nm.assign(noise_Nm.begin(),
                                noise_Nm.begin() + static_cast<std::ptrdiff_t>(drawn.rig.body.joints()));
  return truth;
}

Score score(const Truth& truth, const Diagnosis& diagnosis) {
  Score result;
  for (const EffectFinding& finding : diagnosis.effects) {
    result.false_findings += isFalse(finding, truth) ? 1 : 0;
    result.largest_set = std::max(result.largest_set, 1 + finding.indistinguishable_from.size());
  }
  result.outcome = outcomeOf(truth, diagnosis, result);
  result.named_right = result.outcome == Outcome::kExact || result.outcome == Outcome::kPair;
  if (!truth.effects.empty() && diagnosis.verdict == Verdict::kUnknownEffect) {
    result.right_variable = namesVariable(diagnosis, truth);
  }
  compareParameters(truth, diagnosis, result);
  result.heldout_before = inNoise(diagnosis.before.heldout_rms_Nm, truth.heldout_noise_Nm);
  result.heldout_after = inNoise(diagnosis.after.heldout_rms_Nm, truth.heldout_noise_Nm);
  return result;
}

Score scoreCase(const Case& drawn, const Diagnosis& diagnosis) {
  return score(truthOf(drawn), diagnosis);
}

}  // namespace patella::bench
