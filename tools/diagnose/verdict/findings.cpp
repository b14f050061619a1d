#include "tools/diagnose/verdict/findings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

std::string separatingMotion(std::string_view kind) {
  const std::string_view variable = betrayingVariable(kind);
  if (variable == "dq") {
    return "runs at several steady speeds in both directions, with slow reversals";
  }
  if (variable == "tau") {
    return "fast steps of torque against slow motion, so that the torque changes while position and velocity "
           "hardly do";
  }
  if (variable == "ddq") {
    return "the same path at two or three times the speed, so that acceleration no longer goes with position";
  }
  if (variable == "time") {
    return "a longer recording, with the same motion at its beginning and at its end";
  }
  if (variable == "activation") {
    return "the same motion with the muscles relaxed";
  }
  return "slow motion through the whole range, then the same path fast";
}

void addConfounds(EffectFinding& finding, int joints) {
  const auto& known = finding.indistinguishable_from;
  if (finding.kind == "asymmetric_friction") {
    // Where it takes the place of the model's dry friction, the bias is what it adds.
    const auto& before = finding.replaces;
    const bool rubbed = std::find(before.begin(), before.end(), "coulomb_friction") != before.end();
    finding.indistinguishable_from.emplace_back(rubbed ? "torque_bias" : "coulomb_friction+torque_bias");
  }
  // A contact too stiff to show, or whose stiffness the recording does not tell; a peak that may be none.
  const auto may_be_nothing = [&](std::string_view name) {
    return std::any_of(finding.parameters.begin(), finding.parameters.end(),
                       [name](const ParameterEstimate& estimate) {
                         return estimate.name == name && estimate.ci95[0] <= 0.0;
                       });
  };
  const bool at_bound = std::any_of(finding.parameters.begin(), finding.parameters.end(),
                                    [](const ParameterEstimate& estimate) { return estimate.at_bound; });
  if (((finding.kind == "presliding_hysteresis" && (at_bound || may_be_nothing("stiffness_Nm_rad"))) ||
       (finding.kind == "stribeck_friction" && may_be_nothing("stribeck_level_Nm"))) &&
      std::find(known.begin(), known.end(), "coulomb_friction") == known.end()) {
    finding.indistinguishable_from.emplace_back("coulomb_friction");
  }
  // A mass where the mechanism's own would have to be for it to weigh and swing like more of the same.
  if (finding.kind == "torque_gain" && joints == 1 && !finding.parameters.empty() &&
      finding.parameters.front().value < 0.0 &&
      std::find(known.begin(), known.end(), "payload") == known.end()) {
    finding.indistinguishable_from.emplace_back("payload");
  }
  // A spring too stiff to show.
  if (finding.kind == "rotor_inertia" &&
      std::find(known.begin(), known.end(), "transmission_elasticity") == known.end()) {
    finding.indistinguishable_from.emplace_back("transmission_elasticity");
  }
  // Only the ratio of two gains shows: the other is a scaling of all parameters.
  const std::string other_gain = fmt::format("torque_gain@{}", 2 - finding.joint);
  if (finding.kind == "torque_gain" && joints == 2 &&
      std::find(known.begin(), known.end(), other_gain) == known.end()) {
    finding.indistinguishable_from.push_back(other_gain);
  }
  if (!finding.indistinguishable_from.empty()) {
    finding.separating_motion = separatingMotion(finding.kind);
  }
}

}  // namespace

std::string beyondTolerance(const Diagnosis& diagnosis) {
  std::string moved;
  std::size_t count = 0;
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    if (parameter.isBeyond()) {
      moved += fmt::format("{}{} from {:.4g} to {:.4g}", moved.empty() ? "" : ", ", parameter.name,
                           parameter.nominal, parameter.refitted);
      ++count;
    }
  }
  if (moved.empty()) {
    return {};
  }
  return fmt::format(
      "The fit took {}, more than {}: a payload, a rotor or a gain of the torque would look the same.", moved,
      count == 1 ? "its tolerance" : "their tolerances");
}

std::string takenUpWithinTolerance(const Diagnosis& diagnosis) {
  const bool heldout = !diagnosis.before.heldout_rms_Nm.empty();
  const auto& given = heldout ? diagnosis.before.heldout_rms_Nm : diagnosis.before.train_rms_Nm;
  const auto& refitted = heldout ? diagnosis.refitted.heldout_rms_Nm : diagnosis.refitted.train_rms_Nm;
  std::optional<std::size_t> most;
  for (std::size_t joint = 0; joint < given.size(); ++joint) {
    if (refitted[joint] < runaway::kTookUp * given[joint] &&
        (!most || refitted[joint] * given[*most] < refitted[*most] * given[joint])) {
      most = joint;
    }
  }
  if (!most || !beyondTolerance(diagnosis).empty()) {
    return {};
  }
  return fmt::format(
      "The model's own parameters, moved within their tolerances, take the error of joint {} from {:.3g} as "
      "given to {:.3g} {}: a payload would look the same.",
      *most + 1, given[*most], refitted[*most], unitsOf(diagnosis, static_cast<int>(*most)).torque);
}

namespace {

// What the asserted effects take from the error of the joint that keeps most of it.
std::string explainedWords(const Diagnosis& diagnosis) {
  const bool heldout = !diagnosis.before.heldout_rms_Nm.empty();
  const auto& refitted = heldout ? diagnosis.refitted.heldout_rms_Nm : diagnosis.refitted.train_rms_Nm;
  const auto& after = heldout ? diagnosis.after.heldout_rms_Nm : diagnosis.after.train_rms_Nm;
  std::size_t worst = refitted.size();
  for (const EffectFinding& effect : diagnosis.effects) {
    const auto joint = static_cast<std::size_t>(effect.joint);
    if (effect.asserted() && joint < refitted.size() &&
        (worst == refitted.size() || after[joint] * refitted[worst] > after[worst] * refitted[joint])) {
      worst = joint;
    }
  }
  if (worst == refitted.size()) {
    return {};
  }
  // The refit of a declared effect has explained what the one in its place does.
  const auto& given = heldout ? diagnosis.before.heldout_rms_Nm : diagnosis.before.train_rms_Nm;
  const bool resized =
      std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const EffectFinding& effect) {
        return effect.asserted() && static_cast<std::size_t>(effect.joint) == worst &&
               !effect.replaces.empty();
      });
  const double before = resized ? given[worst] : refitted[worst];
  return fmt::format("What was found takes the error of joint {} from {:.3g}{} to {:.3g} {}{}.", worst + 1,
                     before, resized ? " as given" : "", after[worst],
                     unitsOf(diagnosis, static_cast<int>(worst)).torque,
                     heldout ? " on the held-out part" : "; the recording is too short to hold a part out");
}

std::string withSentence(std::string text, const std::string& sentence) {
  return sentence.empty() ? text : text.empty() ? sentence : std::move(text) + " " + sentence;
}

// The joint with the largest rest against its torque, of those where more is left than sensors make.
std::string whatIsLeft(const Diagnosis& diagnosis) {
  const RestOfJoint* worst = nullptr;
  for (const RestOfJoint& rest : diagnosis.rests) {
    const bool more = rest.structure_Nm > unknown::kLikeNoise * rest.noise_Nm && rest.torque_Nm > 0.0;
    if (more &&
        (worst == nullptr || rest.structure_Nm * worst->torque_Nm > worst->structure_Nm * rest.torque_Nm)) {
      worst = &rest;
    }
  }
  if (worst == nullptr) {
    return "the residual is no more than noise.";
  }
  const auto joint = static_cast<int>(worst - diagnosis.rests.data());
  const std::string unit = unitsOf(diagnosis, joint).torque;
  return fmt::format(
      "nothing that was looked for explains more. {:.2g} {} are left on joint {}, {:.2g} % of its torque; "
      "sensors make {:.2g} {}. That is a push that was not declared (--person), or something that no test "
      "here tells.",
      worst->structure_Nm, unit, joint + 1, kPercent * worst->structure_Nm / worst->torque_Nm,
      worst->noise_Nm, unit);
}

}  // namespace

std::string_view verdictName(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kEffectFound:
      return "effect_found";
    case Verdict::kNothingMissing:
      return "nothing_missing";
    case Verdict::kUnknownEffect:
      return "unknown_effect";
    case Verdict::kInsufficientExcitation:
      return "insufficient_excitation";
  }
  return "";
}

std::string_view doubtName(Doubt::Kind kind) noexcept {
  switch (kind) {
    case Doubt::kTooPoor:
      return "too_poor";
    case Doubt::kSharedCause:
      return "shared_cause";
    case Doubt::kHeldOutDiffers:
      return "heldout_differs";
    case Doubt::kHeldOutWorse:
      return "heldout_worse";
    case Doubt::kRestingTorque:
      return "resting_torque";
    case Doubt::kRecordingsDisagree:
      return "recordings_disagree";
    case Doubt::kJointUntold:
      return "joint_untold";
    case Doubt::kUnexplained:
      return "unexplained";
    case Doubt::kOutweighed:
      return "outweighed";
    case Doubt::kSingleSinusoids:
      return "single_sinusoids";
    case Doubt::kJointUnexplained:
      return "joint_unexplained";
    case Doubt::kLargeRest:
      return "large_rest";
    case Doubt::kJointAtRest:
      return "joint_at_rest";
    case Doubt::kPlainEffectsUnseen:
      return "plain_effects_unseen";
    case Doubt::kSomeRest:
      return "some_rest";
    case Doubt::kParametersMoved:
      return "parameters_moved";
  }
  return "";
}

EffectFinding findingOf(const std::string& kind, int joint, std::vector<ParameterEstimate> parameters,
                        const Evidence& evidence, int joints, std::vector<std::string> replaces) {
  for (ParameterEstimate& parameter : parameters) {
    for (double& limit : parameter.ci95) {
      limit = parameter.by_factor
                  ? parameter.value * std::pow(limit / parameter.value, asserted::kShapeAllowance)
                  : parameter.value + asserted::kShapeAllowance * (limit - parameter.value);
    }
  }
  EffectFinding finding{.kind = kind,
                        .joint = joint,
                        .parameters = std::move(parameters),
                        .p_value = evidence.p_value,
                        .gain = 0.5 * evidence.gain,
                        .indistinguishable_from = {},
                        .replaces = std::move(replaces),
                        .separating_motion = {}};
  for (const std::string& rival : evidence.rivals) {
    const std::string own_joint = "@" + std::to_string(joint + 1);
    finding.indistinguishable_from.push_back(
        rival.ends_with(own_joint) ? rival.substr(0, rival.size() - own_joint.size()) : rival);
  }
  addConfounds(finding, joints);
  return finding;
}

EffectFinding findingOf(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t index,
                        const Evidence& evidence, int joints) {
  const Term& term = fit.terms[index];
  std::vector<std::string> replaces;
  for (const Term& replaced : term.replaced) {
    replaces.push_back(replaced.recipe->kind);
  }
  EffectFinding finding = findingOf(term.recipe->kind, term.recipe->joint, estimates(fit, covariance, index),
                                    evidence, joints, std::move(replaces));
  if (const std::optional<double> error = torqueError(fit, covariance, index)) {
    finding.torque_error = asserted::kShapeAllowance * *error;
  }
  return finding;
}

void addConfoundsBetween(std::vector<EffectFinding>& findings) {
  for (EffectFinding& friction : findings) {
    const bool constant_beside =
        std::any_of(findings.begin(), findings.end(), [&](const EffectFinding& other) {
          return other.joint == friction.joint &&
                 (other.kind == "linear_stiffness" || other.kind == "passive_knee_moment");
        });
    auto& known = friction.indistinguishable_from;
    if (friction.kind == "coulomb_friction" && constant_beside &&
        std::find(known.begin(), known.end(), "asymmetric_friction") == known.end()) {
      known.emplace_back("asymmetric_friction");
      friction.separating_motion = separatingMotion(friction.kind);
    }
  }
}

std::string explanation(const Diagnosis& diagnosis) {
  switch (diagnosis.verdict) {
    case Verdict::kEffectFound:
      return withSentence(explainedWords(diagnosis), beyondTolerance(diagnosis));
    case Verdict::kNothingMissing:
      return "After the nominal parameters were refitted, " + whatIsLeft(diagnosis);
    case Verdict::kUnknownEffect:
      if (diagnosis.unexplained.empty()) {
        return "Something is missing that no effect of the library explains.";
      }
      return fmt::format(
          "{} that no effect of the library explains: the residual of joint {} depends on {}.",
          diagnosis.effects.empty() ? "Something is missing" : "Beside what was found, something is missing",
          diagnosis.unexplained.front().joint + 1, diagnosis.unexplained.front().variable);
    case Verdict::kInsufficientExcitation:
      return "The motion is too poor to tell; see what could not be identified.";
  }
  return "";
}

}  // namespace patella::diagnose
