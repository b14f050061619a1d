#include "tools/diagnose/verdict/verdict.hpp"

#include <algorithm>
#include <array>

#include "tools/diagnose/verdict/findings.hpp"

namespace patella::diagnose {
namespace {

/// Answers against which a doubt counts.
enum class Against { kEveryAnswer, kEffects, kNothing };

struct Rule {
  Doubt::Kind kind;
  Against against;
  Verdict verdict;
};

// In the order of the kinds.
constexpr std::array kRules{
    Rule{Doubt::kTooPoor, Against::kEveryAnswer, Verdict::kInsufficientExcitation},
    Rule{Doubt::kSharedCause, Against::kEveryAnswer, Verdict::kUnknownEffect},
    Rule{Doubt::kHeldOutDiffers, Against::kEveryAnswer, Verdict::kUnknownEffect},
    Rule{Doubt::kHeldOutWorse, Against::kEveryAnswer, Verdict::kUnknownEffect},
    Rule{Doubt::kRestingTorque, Against::kEveryAnswer, Verdict::kInsufficientExcitation},
    Rule{Doubt::kRecordingsDisagree, Against::kEveryAnswer, Verdict::kUnknownEffect},
    Rule{Doubt::kUnexplained, Against::kEveryAnswer, Verdict::kUnknownEffect},
    Rule{Doubt::kOutweighed, Against::kNothing, Verdict::kUnknownEffect},
    Rule{Doubt::kSingleSinusoids, Against::kEffects, Verdict::kInsufficientExcitation},
    Rule{Doubt::kJointUnexplained, Against::kEveryAnswer, Verdict::kUnknownEffect},
    Rule{Doubt::kLargeRest, Against::kNothing, Verdict::kUnknownEffect},
    Rule{Doubt::kJointUntold, Against::kNothing, Verdict::kInsufficientExcitation},
    Rule{Doubt::kJointAtRest, Against::kNothing, Verdict::kInsufficientExcitation},
    Rule{Doubt::kPlainEffectsUnseen, Against::kNothing, Verdict::kInsufficientExcitation},
    Rule{Doubt::kSomeRest, Against::kNothing, Verdict::kUnknownEffect},
    Rule{Doubt::kParametersMoved, Against::kNothing, Verdict::kUnknownEffect},
};

constexpr bool isInOrder() {
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    if (static_cast<std::size_t>(kRules[i].kind) != i) {
      return false;
    }
  }
  return kRules.size() == static_cast<std::size_t>(Doubt::kParametersMoved) + 1;
}
static_assert(isInOrder());

const Rule& ruleOf(Doubt::Kind kind) noexcept {
  return kRules[static_cast<std::size_t>(kind)];
}

bool counts(const Doubt& doubt, bool effects) noexcept {
  const Against against = ruleOf(doubt.kind).against;
  return against == Against::kEveryAnswer || (against == Against::kEffects) == effects;
}

std::string partlyExplained(const Diagnosis& diagnosis) {
  return diagnosis.before.heldout_rms_Nm.empty()
             ? "What was found explains a part of the residual; the recording is too short to hold a part "
               "out."
             : "What was found explains a part of the residual, of the held-out recording as of the rest.";
}

}  // namespace

const Doubt* decidingDoubt(std::span<const Doubt> doubts, bool effects) noexcept {
  const Doubt* deciding = nullptr;
  for (const Doubt& doubt : doubts) {
    if (counts(doubt, effects) && (deciding == nullptr || doubt.kind < deciding->kind)) {
      deciding = &doubt;
    }
  }
  return deciding;
}

Verdict verdictOf(std::span<const Doubt> doubts, bool effects) noexcept {
  if (const Doubt* deciding = decidingDoubt(doubts, effects)) {
    return ruleOf(deciding->kind).verdict;
  }
  return effects ? Verdict::kEffectFound : Verdict::kNothingMissing;
}

void settle(Diagnosis& diagnosis) {
  const auto& found = diagnosis.effects;
  const bool effects =
      std::any_of(found.begin(), found.end(), [](const EffectFinding& effect) { return effect.asserted(); });
  diagnosis.verdict = verdictOf(diagnosis.doubts, effects);
  const Doubt* deciding = decidingDoubt(diagnosis.doubts, effects);
  diagnosis.explanation =
      deciding != nullptr && !deciding->words.empty() ? deciding->words : explanation(diagnosis);
  if (diagnosis.verdict == Verdict::kEffectFound) {
    for (const Doubt& doubt : diagnosis.doubts) {
      if (doubt.kind == Doubt::kLargeRest) {
        diagnosis.explanation = partlyExplained(diagnosis) + " " + doubt.words;
      } else if (doubt.kind == Doubt::kSomeRest) {
        diagnosis.explanation += " " + doubt.words;
      }
    }
  }
  for (const std::string& remark : diagnosis.remarks) {
    diagnosis.explanation += " " + remark;
  }
}

}  // namespace patella::diagnose
