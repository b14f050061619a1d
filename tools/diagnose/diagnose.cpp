#include "tools/diagnose/diagnose.hpp"

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/checks/drive_timing.hpp"
#include "tools/diagnose/checks/plausibility.hpp"
#include "tools/diagnose/fit/torque_timing.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/search/late_drive.hpp"
#include "tools/diagnose/search/missing_effects.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/before_and_after.hpp"
#include "tools/diagnose/verdict/carried_body.hpp"
#include "tools/diagnose/verdict/cause_hint.hpp"
#include "tools/diagnose/verdict/consistency.hpp"
#include "tools/diagnose/verdict/excitation.hpp"
#include "tools/diagnose/verdict/findings.hpp"
#include "tools/diagnose/verdict/material_rest.hpp"
#include "tools/diagnose/verdict/named_effects.hpp"
#include "tools/diagnose/verdict/plainer_effects.hpp"
#include "tools/diagnose/verdict/power.hpp"
#include "tools/diagnose/verdict/runaways.hpp"
#include "tools/diagnose/verdict/shared_cause.hpp"
#include "tools/diagnose/verdict/unexplained_rest.hpp"
#include "tools/diagnose/verdict/verdict.hpp"

namespace patella::diagnose {
namespace {

void listInputs(std::span<const Recording> recordings, Diagnosis& diagnosis) {
  for (const Recording& recording : recordings) {
    diagnosis.inputs.push_back({.path = recording.name, .sha256 = recording.sha256});
    for (const std::string& warning : recording.warnings) {
      diagnosis.warnings.push_back(recording.name + ": " + warning);
    }
  }
}

std::vector<int> movingJoints(std::span<const JointSignals> signals) {
  std::vector<int> moving;
  for (std::size_t joint = 0; joint < signals.size(); ++joint) {
    if (signals[joint].moves) {
      moving.push_back(static_cast<int>(joint));
    }
  }
  return moving;
}

// The effects of a fit, declared or found.
std::set<std::string> labelsIn(const ModelFit& fit) {
  std::set<std::string> labels;
  for (const Term& term : fit.terms) {
    labels.insert(term.recipe->label());
  }
  return labels;
}

// Nothing is fitted: the model stays as it was given.
Diagnosis undecided(const AnalysedRecordings& recordings, const model::ModelDescription& model,
                    const std::string& reason, const DiagnoseOptions& options, Diagnosis diagnosis) {
  diagnosis.doubts.push_back({Doubt::kTooPoor, reason});
  leaveAsItWas(recordings.train, recordings.heldout, model, diagnosis);
  settle(diagnosis);
  diagnosis.runaways = runawaysOf(diagnosis, model, options.fit());
  return diagnosis;
}

// Whoever reads "nothing is missing" looks no further.
void nameResized(Diagnosis& diagnosis) {
  for (const Runaway& runaway : diagnosis.runaways) {
    if (diagnosis.verdict == Verdict::kNothingMissing && runaway.resized) {
      diagnosis.remarks.push_back("But " + runaway.words + ".");
    }
  }
}

void warnOfRest(const AnalysedRecordings& recordings, Diagnosis& diagnosis) {
  for (const RestingJoint& joint : recordings.resting) {
    const char* const why = joint.pushed ? "rests under a person's push: the way it moves there is hers, and"
                                         : "sticks when it rests: the drive's torque there, which dry "
                                           "friction answers up to its level,";
    diagnosis.warnings.push_back(fmt::format("joint {} {} is not counted; {:.0f} % of the recording",
                                             joint.joint + 1, why, kPercent * recordings.share_left_out));
  }
}

// The nominal parameters may have explained what the user looks for.
void nameTakenUp(Diagnosis& diagnosis) {
  if (const std::string words = takenUpWithinTolerance(diagnosis);
      !words.empty() && diagnosis.verdict != Verdict::kInsufficientExcitation) {
    diagnosis.remarks.push_back(words);
  }
}

/// What a diagnosis with it taken out, or in the model, has to bear out.
struct Suspects {
  std::optional<SharedCause> cause;
  std::optional<CarriedBody> body;
};

// From recordings that can be of this machine, and the time at which their torque acted. `cause_Nm`: of a
// cause that all joints share and that was taken out, on each joint.
Diagnosis diagnoseTimed(std::span<const Recording> recordings, std::span<const Recording> holdout,
                        const model::ModelDescription& model, const DiagnoseOptions& options,
                        std::span<const double> cause_Nm, Suspects& suspects) {
  Diagnosis diagnosis;
  diagnosis.seed = options.seed;
  diagnosis.extended = model;
  diagnosis.drive_timing = driveTiming(recordings);
  listInputs(recordings, diagnosis);
  listInputs(holdout, diagnosis);

  AnalysedRecordings analysed(recordings, holdout, options.holdout_fraction);
  const Dataset& train = analysed.train;
  const std::vector<JointSignals> signals = jointSignals(recordings);
  describeMotion(signals, diagnosis);
  if (const std::string reason = obstacle(signals, train, model); !reason.empty()) {
    return undecided(analysed, model, reason, options, std::move(diagnosis));
  }

  analysed.predictTorque(model, options.person_Nm, options.fit());
  warnOfRest(analysed, diagnosis);
  const model::DynamicsModel bare = model::makeModel({.mechanism = model.mechanism, .effects = {}});
  const std::vector<double> noise_Nm =
      knownNoise_Nm(analysed.parts.train, bare.mechanism(), train.band_Hz(), options.person_Nm);
  MissingEffects found = findMissing(analysed, model, movingJoints(signals), noise_Nm, options);
  diagnosis.warnings.insert(diagnosis.warnings.end(), found.warnings.begin(), found.warnings.end());
  if (options.gates.rest) {
    preferPlainer(bare.mechanism(), noise_Nm, options, found);
  }

  options.report("unexplained", 0.0);
  const UnexplainedRest left = unexplainedRest(analysed, bare.mechanism(), noise_Nm, options, found);
  const ModelFit& fit = found.selection.fit;
  nameEffects(analysed, found, left, options, cause_Nm, diagnosis);
  judgeConsistency(train, fit, analysed.names, diagnosis);
  judgeRest(left.joints, jointRms(train, found.nominal.residual), !options.person_Nm.empty(), diagnosis);
  judgeExcitation(signals, train, fit, found.atoms, diagnosis);
  diagnosis.revealed =
      revealedBy(*found.fitter, fit, found.atoms, diagnosis.rests, labelsIn(fit), chanceOf(diagnosis, fit));

  options.report("errors", 0.0);
  judgeByErrors({.train = train,
                 .heldout = analysed.heldout,
                 .given = model,
                 .refitted = found.refitted,
                 .extended = found.fitter->describe(fit),
                 .unexplained = left.whole.residual},
                diagnosis);
  settle(diagnosis);
  if (diagnosis.verdict == Verdict::kUnknownEffect) {
    if (std::string hint = causeHint(train, model, found.nominal); !hint.empty()) {
      diagnosis.remarks.push_back(std::move(hint));
    }
  }
  diagnosis.runaways = runawaysOf(diagnosis, model, options.fit());
  nameResized(diagnosis);
  nameTakenUp(diagnosis);
  settle(diagnosis);
  suspects.cause = suspectedCause(train, leastLateness_s(recordings), model, found.nominal, fit, diagnosis);
  suspects.body = suspectedBody(train, model, options.fit(), fit.redundancy(), diagnosis);
  return diagnosis;
}

// Takes out the base and the torque columns, each once. Nothing where no suspected cause is borne out.
std::optional<Diagnosis> withoutSharedCauses(std::vector<Recording> timed,
                                             std::vector<Recording> timed_holdout,
                                             model::ModelDescription model, const DiagnoseOptions& options,
                                             const Diagnosis& as_given, Suspects& suspects) {
  std::optional<Diagnosis> diagnosis;
  std::vector<SharedCause> causes;
  while (suspects.cause && (causes.empty() || (causes.size() == 1 &&
                                               causes.front().isOfBase() != suspects.cause->isOfBase()))) {
    causes.push_back(*std::exchange(suspects.cause, std::nullopt));
    timed = causes.back().takenOutOf(timed);
    timed_holdout = causes.back().takenOutOf(timed_holdout);
    model = causes.back().takenOutOf(std::move(model));
    Diagnosis taken_out =
        diagnoseTimed(timed, timed_holdout, model, options, causes.back().torque_Nm, suspects);
    const Diagnosis& before = diagnosis ? *diagnosis : as_given;
    if (!bearsOut(taken_out, before)) {
      break;
    }
    diagnosis = withCauses(causes, std::move(taken_out), before);
  }
  return diagnosis;
}

}  // namespace

Diagnosis diagnose(std::span<const Recording> recordings, std::span<const Recording> holdout,
                   const model::ModelDescription& model, const DiagnoseOptions& options) {
  requirePlausible(recordings, model);
  requirePlausible(holdout, model);
  std::vector<Recording> timed = withTorqueTiming(recordings, model, options.fit());
  std::vector<Recording> timed_holdout(holdout.begin(), holdout.end());
  for (Recording& recording : timed_holdout) {
    recording.torque_timing =
        recording.torque_timing_assumed ? timed.front().torque_timing : recording.torque_timing;
  }
  Suspects suspects;
  Diagnosis diagnosis = diagnoseTimed(timed, timed_holdout, model, options, {}, suspects);
  const std::optional<CarriedBody> body = suspects.body;
  if (std::optional<Diagnosis> taken_out =
          withoutSharedCauses(timed, timed_holdout, model, options, diagnosis, suspects)) {
    return *std::move(taken_out);
  }
  if (body) {
    Diagnosis with_body =
        diagnoseTimed(timed, timed_holdout, withBody(model, body->body), options, {}, suspects);
    if (bodyBearsOut(with_body, diagnosis)) {
      return withBodyFound(*body, std::move(with_body), diagnosis);
    }
  }
  return diagnosis;
}

}  // namespace patella::diagnose
