// How a diagnosis is marked against what the simulated rig really had.
//
// Rules
//   A finding offers alternatives: its own kind on its joint, and each entry of indistinguishable_from. An
//   entry may be a sum "kind+kind"; a part without "@joint" is on the finding's joint. An EMG torque from
//   another channel is another effect. Named right: verdict effect_found, and one alternative can be chosen
//   of each finding so that together they are exactly the true effects. `exact` where no finding offers more
//   than one alternative, `pair` where none offers more than two, `larger set` otherwise, which is counted
//   apart. A finding is false where none of its alternatives consists of true effects alone. Kinds count as
//   they are called: a Coulomb friction found as an asymmetric one with equal levels is false. A case where
//   nothing is missing is right with the verdict nothing_missing and no finding; any finding is false, and so
//   is the verdict unknown_effect. A case with an effect beyond the library is right with the verdict
//   unknown_effect, whatever was found besides. Right variable: of the dependences that are left, the
//   strongest names a variable that the true torque depends on. "ddq1*q2" names both. For effects of the
//   library it is asked for where they were called unknown. Effects that masses, centres of mass and inertias
//   could take the place of are counted apart: naming them, naming a set with them and refitting them away
//   are all right. Parameters are compared where the finding's own kind is true, but for damping that a dry
//   friction leaves to the effect that the model declares for it. Held-out error counts against the noise
//   that the simulator knows of, in the same band, joints together as root mean square of the ratios.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/bench/diagnose/cases.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::bench {

struct NamedValue {
  std::string name;
  double value = 0.0;
};

struct TrueFinding {
  std::string kind;
  int joint = 0;                       ///< from 0
  std::vector<NamedValue> parameters;  ///< those that are compared
  int emg_channel = 0;                 ///< from 1; 0: none
};

/// The right answer to a case.
struct Truth {
  Suite suite = Suite::kNone;
  std::vector<TrueFinding> effects;
  std::vector<std::string> variables;  ///< "dq1", "time": any is right
  bool in_span = false;
  std::vector<double> heldout_noise_Nm;  ///< per joint, in the band of the diagnosis
};

enum class Outcome {
  kExact,
  kPair,
  kLargerSet,
  kPartly,     ///< some true effects, nothing false
  kFalse,      ///< at least one false finding
  kNothing,    ///< verdict nothing_missing where something was
  kUnknown,    ///< verdict unknown_effect
  kAbstained,  ///< verdict insufficient_excitation
  kRight,      ///< of cases with nothing missing, or something beyond the library
  kFailed,     ///< diagnosis threw; never right
};
std::string_view outcomeName(Outcome outcome) noexcept;

struct ParameterScore {
  std::string name;
  double truth = 0.0;
  double estimate = 0.0;
  std::array<double, 2> ci95{};

  double relativeError() const noexcept;
  bool covered() const noexcept { return ci95[0] <= truth && truth <= ci95[1]; }
};

struct Score {
  Outcome outcome = Outcome::kNothing;
  bool named_right = false;  ///< kExact or kPair
  int false_findings = 0;
  std::size_t largest_set = 0;
  std::optional<bool> right_variable;
  std::vector<ParameterScore> parameters;
  std::optional<double> heldout_before, heldout_after;  ///< in units of the noise
};

Truth truthOf(const Case& drawn);
Score score(const Truth& truth, const diagnose::Diagnosis& diagnosis);
Score scoreCase(const Case& drawn, const diagnose::Diagnosis& diagnosis);

/// The allowed findings: each alternative is a sum of effects on joints from 0.
struct Part {
  std::string kind;
  int joint = 0;
  bool operator==(const Part&) const = default;
};
std::vector<std::vector<Part>> alternatives(const diagnose::EffectFinding& finding);

}  // namespace patella::bench
