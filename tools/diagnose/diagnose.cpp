#include "tools/diagnose/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "tools/diagnose/checks/drive_timing.hpp"
#include "tools/diagnose/checks/plausibility.hpp"
#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/fit/torque_timing.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/search/correlations.hpp"
#include "tools/diagnose/search/established.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/free_function.hpp"
#include "tools/diagnose/search/friction_smoothing.hpp"
#include "tools/diagnose/search/heldout_elimination.hpp"
#include "tools/diagnose/search/late_drive.hpp"
#include "tools/diagnose/search/selection.hpp"
#include "tools/diagnose/verdict/before_and_after.hpp"
#include "tools/diagnose/verdict/consistency.hpp"
#include "tools/diagnose/verdict/dependence.hpp"
#include "tools/diagnose/verdict/excitation.hpp"
#include "tools/diagnose/verdict/findings.hpp"
#include "tools/diagnose/verdict/runaways.hpp"
#include "tools/diagnose/verdict/unknown_rest.hpp"
#include "tools/diagnose/verdict/wandering_tremor.hpp"

namespace patella::diagnose {
namespace {

/// Times the level of a step, that of a dependence behind named effects. Where nothing was named it would
/// overturn "nothing is missing", which has to be rare; here it only makes an answer more careful.
constexpr double kLevelBehindNamed = 2.0;

/// Square of the standard deviations by which slow motion may speak against what fast motion says of a drive.
constexpr double kContradicted = 9.0;
/// Of the held-out error, what a delay must leave at most.
constexpr double kShows = 0.99;

bool isTiming(std::string_view kind) {
  return kind == "actuator_delay" || kind == "actuator_lag";
}

// One run of the procedure: holds what its stages share.
class Procedure {
 public:
  Procedure(std::span<const Recording> recordings, std::span<const Recording> holdout,
            const app::ModelDescription& model, const DiagnoseOptions& options)
      : model_(model), options_(options), channels_(recordedChannels(recordings)) {
    parts_ = split(recordings, holdout.empty() ? options.holdout_fraction : 0.0);
    const DatasetOptions dataset_options{.band_Hz = motionBand_Hz(parts_.train)};
    DatasetOptions train_options = dataset_options;
    train_options.asked_part = true;
    train_.emplace(parts_.train, train_options);
    wide_.emplace(parts_.train, DatasetOptions{});
    if (!holdout.empty()) {
      heldout_.emplace(holdout, dataset_options);
    } else if (!parts_.heldout.empty()) {
      heldout_.emplace(parts_.heldout, dataset_options);
    }
    result_.seed = options.seed;
    if (std::holds_alternative<model::PrismaticJointParameters>(model.mechanism)) {
      result_.torque_unit = "N";
    }
    result_.drive_timing = driveTiming(recordings);
    for (const auto& list : {recordings, holdout}) {
      for (const Recording& recording : list) {
        result_.inputs.push_back({.path = recording.name, .sha256 = recording.sha256});
        for (const std::string& warning : recording.warnings) {
          result_.warnings.push_back(recording.name + ": " + warning);
        }
      }
    }
    for (const Recording& recording : recordings) {
      names_.push_back(recording.name);
    }
    signals_ = jointSignals(recordings);
    describeMotion(signals_, result_);
  }

  Diagnosis run() {
    if (const std::string reason = obstacle(signals_, *train_, model_); !reason.empty()) {
      return undecided(reason);
    }
    Search first = search(model_, {});
    findLate(first);
    // Time base first: with the drives' delays known, what is missing is looked for anew.
    while (!late_.empty()) {
      again_.emplace(search(withLate(), lateJoints()));
      if (!dropLateThatDoesNotHold(first)) {
        break;
      }
    }
    Search& last = late_.empty() ? first : *again_;
    if (heldout_ && options_.gates.heldout) {
      for (const std::string& label : dropWhatDoesNotHold(*last.fitter, last.selection, *heldout_)) {
        result_.warnings.push_back(
            label + " explained a part of the recording, but not the held-out part: not added");
      }
    }
    for (const std::string& label : dropWhatIsNotEstablished(
             *last.fitter, last.selection, options_.bootstrap_replicates, covarianceSeed())) {
      result_.warnings.push_back(
          label + " explained a part of the recording, but its parameters are not known: not added");
    }
    report("unexplained", 0.0);
    const std::vector<Dependence> dependences = testDependence(
        *train_, last.fitter->onWholeTorque(last.selection.fit), channels_, 4 * options_.bootstrap_replicates,
        (namesAny(last.selection) ? kLevelBehindNamed : 1.0) * options_.family_wise_p,
        options_.seed + 104729);
    decide(*last.fitter, first.nominal, last.selection, dependences);
    compareRecordings(last.selection.fit);
    judgeRest(last.fitter->onWholeTorque(last.selection.fit).residual);
    judgeExcitation(signals_, *train_, last.selection.fit, last.atoms, options_.nominal_tolerance, result_);
    report("errors", 0.0);
    judgeByErrors({.train = *train_,
                   .heldout = heldout_,
                   .given = model_,
                   .refitted = first.fitter->describe(first.nominal),
                   .extended = last.fitter->describe(last.selection.fit),
                   .unexplained = last.fitter->onWholeTorque(last.selection.fit).residual},
                  result_);
    if (result_.explanation.empty()) {
      result_.explanation = explanation(result_, options_.nominal_tolerance);
    }
    result_.runaways = runawaysOf(result_, model_, fitOptions());
    return std::move(result_);
  }

 private:
  /// A search for what one model lacks.
  struct Search {
    std::unique_ptr<ModelFitter> fitter;
    ModelFit nominal;
    Atoms atoms;
    Selection selection;
  };

  Search search(const app::ModelDescription& model, std::span<const int> timed_joints) {
    report("columns", 0.0);
    Search search{.fitter = std::make_unique<ModelFitter>(*train_, model, fitOptions()),
                  .nominal = {},
                  .atoms = {},
                  .selection = {}};
    search.fitter->setRedundancy(redundancy(*train_, search.fitter->nominal(), options_.seed));
    search.nominal = search.fitter->nominal();
    const std::vector<std::string> kinds = consideredKinds(options_.effects);
    const bool leg = !std::holds_alternative<model::PrismaticJointParameters>(model.mechanism);
    auto considered = recipes(*train_, app::makeModel(model).mechanism(), kinds, channels_,
                              frictionSmoothing(*search.fitter, search.nominal, options_.seed), leg);
    std::erase_if(considered, [&](const auto& recipe) {
      const bool timed =
          std::find(timed_joints.begin(), timed_joints.end(), recipe->joint) != timed_joints.end();
      return !signals_[static_cast<std::size_t>(recipe->joint)].moves || (timed && isTiming(recipe->kind));
    });
    search.atoms = recipeAtoms(*search.fitter, considered);
    report("search", 0.0);
    SelectionOptions selection = selectionOptions();
    selection.progress = [this](double fraction) { report("search", fraction); };
    search.selection = select(*search.fitter, search.atoms, search.nominal, selection);
    return search;
  }

  std::uint64_t covarianceSeed() const { return options_.seed + 15485863; }

  FitOptions fitOptions() const { return {.nominal_tolerance = options_.nominal_tolerance}; }

  SelectionOptions selectionOptions() const {
    return {.replicates = options_.bootstrap_replicates,
            .family_wise_p = options_.family_wise_p,
            .seed = options_.seed,
            .gates = options_.gates,
            .progress = {}};
  }

  // On joints whose drive the first search has not timed already.
  void findLate(const Search& first) {
    std::vector<int> joints;
    for (int joint = 0; joint < train_->joints(); ++joint) {
      const auto& terms = first.selection.fit.terms;
      if (signals_[static_cast<std::size_t>(joint)].moves &&
          std::none_of(terms.begin(), terms.end(), [&](const Term& term) {
            return term.recipe->joint == joint && isTiming(term.recipe->kind);
          })) {
        joints.push_back(joint);
      }
    }
    if (considersTiming()) {
      late_ = findLateDrives(parts_.train, first.fitter->describe(first.selection.fit), joints, fitOptions(),
                             selectionOptions());
    }
    std::erase_if(late_, [&](const LateDrive& late) { return !slowMotionAgrees(late, first); });
  }

  // A drive is as late in slow motion as in fast, where vibration of the structure may pass for a delay.
  bool slowMotionAgrees(const LateDrive& late, const Search& first) const {
    app::ModelDescription model = model_;
    model.effects.push_back(late.effect);
    ModelFitter fitter(*train_, model, fitOptions());
    const ModelFit& fit = first.selection.fit;
    const double spoken_against = fitter.fit(fit, *fit.weighting).objective - fit.objective;
    return spoken_against < kContradicted * fit.prior_scale * fit.prior_scale;
  }

  // A delay that fast motion asks for shows in the error of data that were not fitted. True where one was
  // dropped.
  bool dropLateThatDoesNotHold(const Search& first) {
    if (!heldout_ || !options_.gates.heldout) {
      return false;
    }
    const auto errors = [&](const Search& search) {
      return residualOf(*heldout_, search.fitter->describe(search.selection.fit)).residual;
    };
    const Column without = errors(first);
    const Column with = errors(*again_);
    return std::erase_if(late_, [&](const LateDrive& late) {
             const bool holds = jointRms(*heldout_, with, late.effect.joint) <
                                kShows * jointRms(*heldout_, without, late.effect.joint);
             if (!holds) {
               result_.warnings.push_back(
                   fmt::format("{}@{} explained fast motion, but not the held-out part: not added",
                               late.effect.kind, late.effect.joint + 1));
             }
             return !holds;
           }) > 0;
  }

  bool considersTiming() const {
    return options_.effects.empty() || std::any_of(options_.effects.begin(), options_.effects.end(),
                                                   [](const std::string& kind) { return isTiming(kind); });
  }

  app::ModelDescription withLate() const {
    app::ModelDescription model = model_;
    for (const LateDrive& late : late_) {
      model.effects.push_back(late.effect);
    }
    return model;
  }

  std::vector<int> lateJoints() const {
    std::vector<int> joints;
    for (const LateDrive& late : late_) {
      joints.push_back(late.effect.joint);
    }
    return joints;
  }

  void report(std::string_view stage, double fraction) const {
    if (options_.progress) {
      options_.progress(stage, fraction);
    }
  }

  bool namesAny(const Selection& selection) const {
    const auto& terms = selection.fit.terms;
    return !late_.empty() ||
           std::any_of(terms.begin(), terms.end(), [](const Term& term) { return !term.declared; });
  }

  void decide(ModelFitter& fitter, const ModelFit& nominal, const Selection& selection,
              const std::vector<Dependence>& dependences) {
    result_.steps = selection.steps;
    result_.unexplained = dependences;
    const Eigen::MatrixXd covariance =
        widerCovariance(*train_, selection.fit, options_.bootstrap_replicates, covarianceSeed());
    const std::vector<FreeFunction> free = freeFunctions(*train_, selection);
    for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
      const Term& term = selection.fit.terms[t];
      if (term.declared) {
        continue;
      }
      result_.effects.push_back(findingOf(term.recipe->kind, term.recipe->joint,
                                          estimates(selection.fit, covariance, t), selection.evidence[t],
                                          train_->joints()));
      for (const Term& replaced : term.replaced) {
        result_.effects.back().replaces.push_back(replaced.recipe->kind);
      }
      for (const FreeFunction& function : free) {
        if (function.holds(t)) {
          result_.effects.back().indistinguishable_from.push_back("any function of " +
                                                                  function.dependence.variable);
        }
      }
    }
    for (const LateDrive& late : late_) {
      result_.effects.push_back(
          findingOf(late.effect.kind, late.effect.joint, {late.estimate}, late.evidence, train_->joints()));
    }
    addConfoundsBetween(result_.effects);
    addTremors(fitter.describe(selection.fit));
    // An effect that comes and goes, or is of another shape than any of the library, is not nothing.
    if (result_.effects.empty() && result_.unexplained.empty() && selection.unsteady) {
      result_.unexplained.push_back(*selection.unsteady);
    }
    const Eigen::VectorXd missing = withoutReplaced(fitter, nominal.residual, selection.fit);
    const Eigen::VectorXd left = fitter.onWholeTorque(selection.fit).residual;
    const bool unexplained =
        restIsUnknown(*train_, {.missing = missing, .left = left}, result_.effects, result_.unexplained);
    for (const FreeFunction& function : free) {
      result_.unexplained.insert(result_.unexplained.begin(), function.dependence);
    }
    if (unexplained || !free.empty()) {
      result_.verdict = Verdict::kUnknownEffect;
    } else if (!result_.effects.empty()) {
      result_.verdict = Verdict::kEffectFound;
    } else {
      result_.verdict = Verdict::kNothingMissing;
    }
    result_.nominal = refittedParameters(fitter, selection.fit, covariance);
    result_.correlations = correlationsOf(selection.fit, fitter.mechanismNames(), covariance);
  }

  // What found effects explain includes what the declared ones did that they replaced.
  static Eigen::VectorXd withoutReplaced(ModelFitter& fitter, Eigen::VectorXd residual, const ModelFit& fit) {
    for (const Term& term : fit.terms) {
      for (const Term& replaced : term.replaced) {
        residual += fitter.torque(replaced);
      }
    }
    return residual;
  }

  // Runs that contradict each other have no common answer.
  void compareRecordings(const ModelFit& fit) {
    const Contradictions found = contradictions(*train_, fit, names_);
    if (found.what.empty()) {
      return;
    }
    result_.verdict = Verdict::kUnknownEffect;
    result_.explanation = "The recordings contradict each other: " + found.what.front() + ".";
    result_.unexplained.insert(result_.unexplained.begin(), found.dependences.begin(),
                               found.dependences.end());
    result_.warnings.insert(result_.warnings.end(), found.what.begin(), found.what.end());
  }

  // A noise model takes up whatever is slow or periodic; sensors make noise of a size of their own.
  void judgeRest(const Column& left) {
    const model::DynamicsModel bare = app::makeModel({.mechanism = model_.mechanism, .effects = {}});
    const std::vector<JointRest> rests =
        jointRests(*train_, bare.mechanism(), left,
                   knownNoise_Nm(parts_.train, bare.mechanism(), train_->band_Hz(), options_.person_Nm));
    for (const JointRest& rest : rests) {
      result_.rests.push_back(
          {.torque_Nm = rest.torque_Nm, .structure_Nm = rest.structure_Nm(), .noise_Nm = rest.noise_Nm});
    }
    const auto worst = std::max_element(rests.begin(), rests.end(), [](const auto& a, const auto& b) {
      return a.structure_Nm() * b.torque_Nm < b.structure_Nm() * a.torque_Nm;
    });
    if (result_.verdict == Verdict::kNothingMissing && worst->exceeds(kMaterialRest)) {
      result_.verdict = Verdict::kUnknownEffect;
      result_.explanation = fmt::format(
          "No effect of the library explains what is left: {:.3g} {} on joint {}, {:.0f} % of its torque, "
          "where sensors{} make {:.2g} {}. Pushes of a person are to be declared (--person).",
          worst->structure_Nm(), result_.torque_unit, worst - rests.begin() + 1,
          100.0 * worst->structure_Nm() / worst->torque_Nm,
          options_.person_Nm.empty() ? "" : " and declared pushes", worst->noise_Nm, result_.torque_unit);
    }
  }

  // Nothing was fitted: the model stays as it was given.
  Diagnosis undecided(const std::string& reason) {
    result_.verdict = Verdict::kInsufficientExcitation;
    result_.explanation = reason;
    leaveAsItWas(*train_, heldout_, model_, result_);
    result_.runaways = runawaysOf(result_, model_, fitOptions());
    return std::move(result_);
  }

  void addTremors(const app::ModelDescription& extended) {
    const auto& kinds = options_.effects;
    const bool considered = kinds.empty() || std::find(kinds.begin(), kinds.end(), "tremor") != kinds.end();
    if (!considered) {
      return;
    }
    for (EffectFinding& tremor : wanderingTremors(*wide_, extended, result_.effects)) {
      result_.warnings.push_back(fmt::format(
          "the phase of joint {}'s tremor wanders: it is named, but not added to the model, which "
          "could not foresee it",
          tremor.joint + 1));
      result_.effects.push_back(std::move(tremor));
    }
  }

  app::ModelDescription model_;
  DiagnoseOptions options_;
  std::vector<int> channels_;
  std::vector<std::string> names_;  ///< of the recordings
  std::vector<JointSignals> signals_;
  SplitRecordings parts_;
  std::vector<LateDrive> late_;
  std::optional<Search> again_;  ///< with the delays of late drives in the model
  std::optional<Dataset> train_;
  std::optional<Dataset> wide_;  ///< the same, up to the highest frequency of a tremor
  std::optional<Dataset> heldout_;
  Diagnosis result_;
};

}  // namespace

Diagnosis diagnose(std::span<const Recording> recordings, std::span<const Recording> holdout,
                   const app::ModelDescription& model, const DiagnoseOptions& options) {
  requirePlausible(recordings, model);
  requirePlausible(holdout, model);
  const std::vector<Recording> timed = withTorqueTiming(recordings, model);
  std::vector<Recording> timed_holdout(holdout.begin(), holdout.end());
  for (Recording& recording : timed_holdout) {
    recording.torque_timing =
        recording.torque_timing_assumed ? timed.front().torque_timing : recording.torque_timing;
  }
  return Procedure(timed, timed_holdout, model, options).run();
}

}  // namespace patella::diagnose
