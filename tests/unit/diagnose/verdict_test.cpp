// The verdict follows from what was found and what stands against it, and from nothing else.
#include "tools/diagnose/verdict/verdict.hpp"

#include <array>
#include <vector>

#include <doctest/doctest.h>

#include "tools/diagnose/verdict/findings.hpp"

using namespace patella::diagnose;

namespace {

Doubt doubt(Doubt::Kind kind) {
  return {.kind = kind, .words = std::string(doubtName(kind))};
}

}  // namespace

TEST_CASE("without a doubt, effects are found or nothing is missing") {
  CHECK(verdictOf({}, true) == Verdict::kEffectFound);
  CHECK(verdictOf({}, false) == Verdict::kNothingMissing);
}

TEST_CASE("each doubt alone makes of either answer what is written here") {
  struct Row {
    Doubt::Kind kind;
    Verdict effects;
    Verdict nothing;
  };
  constexpr Verdict kFound = Verdict::kEffectFound;
  constexpr Verdict kNone = Verdict::kNothingMissing;
  constexpr Verdict kUnknown = Verdict::kUnknownEffect;
  constexpr Verdict kPoor = Verdict::kInsufficientExcitation;
  constexpr std::array kRows{
      Row{Doubt::kTooPoor, kPoor, kPoor},
      Row{Doubt::kHeldOutDiffers, kUnknown, kUnknown},
      Row{Doubt::kHeldOutWorse, kUnknown, kUnknown},
      Row{Doubt::kRestingTorque, kPoor, kPoor},
      Row{Doubt::kRecordingsDisagree, kUnknown, kUnknown},
      Row{Doubt::kUnexplained, kUnknown, kUnknown},
      Row{Doubt::kOutweighed, kFound, kUnknown},
      Row{Doubt::kSingleSinusoids, kPoor, kNone},
      Row{Doubt::kJointUnexplained, kUnknown, kUnknown},
      Row{Doubt::kLargeRest, kFound, kUnknown},
      Row{Doubt::kJointUntold, kFound, kPoor},
      Row{Doubt::kJointAtRest, kFound, kPoor},
      Row{Doubt::kPlainEffectsUnseen, kFound, kPoor},
      Row{Doubt::kSomeRest, kFound, kUnknown},
      Row{Doubt::kParametersMoved, kFound, kUnknown},
  };
  for (const Row& row : kRows) {
    CAPTURE(doubtName(row.kind));
    const std::array doubts{doubt(row.kind)};
    CHECK(verdictOf(doubts, true) == row.effects);
    CHECK(verdictOf(doubts, false) == row.nothing);
  }
}

TEST_CASE("of several doubts the first that counts decides, in whatever order they came up") {
  const std::array doubts{doubt(Doubt::kLargeRest), doubt(Doubt::kPlainEffectsUnseen), doubt(Doubt::kTooPoor),
                          doubt(Doubt::kUnexplained)};
  CHECK(decidingDoubt(doubts, false)->kind == Doubt::kTooPoor);
  CHECK(decidingDoubt(std::span(doubts).first(2), false)->kind == Doubt::kLargeRest);
  CHECK(decidingDoubt(std::span(doubts).first(2), true) == nullptr);
}

TEST_CASE("a diagnosis says what decided, and what a found effect leaves") {
  Diagnosis diagnosis;
  diagnosis.doubts = {doubt(Doubt::kLargeRest)};
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  CHECK(diagnosis.explanation == "large_rest");

  diagnosis.effects.emplace_back();
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
  CHECK(diagnosis.explanation.starts_with("What was found explains a part of the residual"));
  CHECK(diagnosis.explanation.ends_with(" large_rest"));
}

TEST_CASE("effects that explain less than what nothing explains are not asserted") {
  Diagnosis diagnosis;
  diagnosis.effects.emplace_back();
  diagnosis.effects.back().not_asserted_because = kOutweighedWords;
  diagnosis.doubts = {doubt(Doubt::kOutweighed)};
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);

  diagnosis.effects.emplace_back();
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kEffectFound);
}

TEST_CASE("an answer has the error of the joint that keeps most of it, held out where there was a part") {
  Diagnosis diagnosis;
  diagnosis.effects.resize(2);
  diagnosis.effects[1].joint = 1;
  diagnosis.refitted.train_rms_Nm = {2.0, 1.0};
  diagnosis.after.train_rms_Nm = {0.25, 0.5};
  settle(diagnosis);
  CHECK(diagnosis.explanation ==
        "What was found takes the error of joint 2 from 1 to 0.5 N·m; the recording is too short to hold a "
        "part "
        "out.");
  diagnosis.before.heldout_rms_Nm = {3.0, 3.0};
  diagnosis.refitted.heldout_rms_Nm = {2.5, 1.5};
  diagnosis.after.heldout_rms_Nm = {2.25, 0.5};
  settle(diagnosis);
  CHECK(diagnosis.explanation ==
        "What was found takes the error of joint 1 from 2.5 to 2.25 N·m on the held-out part.");
}

TEST_CASE("parameters that took up what is missing are not nothing") {
  Diagnosis diagnosis;
  diagnosis.doubts = {doubt(Doubt::kParametersMoved)};
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kUnknownEffect);
  CHECK(diagnosis.explanation == "parameters_moved");
}

TEST_CASE(
    "parameters out of their tolerance are told beside what was found, since a payload moves them, too") {
  Diagnosis diagnosis;
  diagnosis.effects.emplace_back();
  diagnosis.nominal = {{.name = "mass_kg[1]", .nominal = 3.0, .refitted = 3.1, .tolerated = {2.5, 3.6}},
                       {.name = "mass_kg[2]", .nominal = 2.0, .refitted = 2.6, .tolerated = {1.6, 2.4}},
                       {.name = "com_m[2]", .nominal = 0.11, .refitted = 0.16, .tolerated = {0.09, 0.13}}};
  settle(diagnosis);
  CHECK(
      diagnosis.explanation.find(
          "The fit took mass_kg[2] from 2 to 2.6, com_m[2] from 0.11 to 0.16, more than their tolerances: a "
          "payload") != std::string::npos);
  diagnosis.nominal.resize(1);
  settle(diagnosis);
  CHECK(diagnosis.explanation.find("The fit took") == std::string::npos);
}

TEST_CASE("nothing missing says what is left where sensors do not make it, and noise where they do") {
  Diagnosis diagnosis;
  diagnosis.rests = {{.torque_Nm = 10.0, .structure_Nm = 0.02, .noise_Nm = 0.014},
                     {.torque_Nm = 5.0, .structure_Nm = 0.02, .noise_Nm = 0.014}};
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kNothingMissing);
  CHECK(diagnosis.explanation ==
        "After the nominal parameters were refitted, the residual is no more than noise.");
  diagnosis.rests[1].structure_Nm = 0.225;
  settle(diagnosis);
  CHECK(diagnosis.verdict == Verdict::kNothingMissing);
  CHECK(diagnosis.explanation ==
        "After the nominal parameters were refitted, nothing that was looked for explains more. 0.23 N·m are "
        "left on "
        "joint 2, 4.5 % of its torque; sensors make 0.014 N·m. That is a push that was not declared "
        "(--person), or "
        "something that no test here tells.");
}
