#include "tools/diagnose/search/missing_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/search/established.hpp"
#include "tools/diagnose/search/friction_smoothing.hpp"
#include "tools/diagnose/search/heldout_elimination.hpp"
#include "tools/diagnose/search/outweighed.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

bool holds(std::span<const int> joints, int joint) {
  return std::find(joints.begin(), joints.end(), joint) != joints.end();
}

// Whether only one joint of several is driven. The others move alike with all masses larger or smaller by one
// factor, and the gain of the only drive makes up for any factor.
bool isOnlyDrive(const Dataset& data, const model::ModelDescription& model) {
  const model::DynamicsModel bare = model::makeModel({.mechanism = model.mechanism, .effects = {}});
  const std::vector<bool> driven = drivenJoints(data, bare.mechanism());
  return driven.size() > 1 && std::count(driven.begin(), driven.end(), true) <= 1;
}

class Finder {
 public:
  Finder(const AnalysedRecordings& recordings, const model::ModelDescription& model,
         std::span<const int> moving, std::span<const double> noise_Nm, const DiagnoseOptions& options)
      : recordings_(recordings), model_(model), moving_(moving), noise_Nm_(noise_Nm), options_(options) {}

  MissingEffects find() {
    MissingEffects first = search(model_, {});
    first.refitted = first.fitter->describe(first.nominal);
    late_ = lateDrives(first);
    MissingEffects found;
    bool settled = late_.empty();
    while (!settled) {
      found = search(withLate(), lateJoints());
      settled = !dropLateThatDoesNotHold(first, found) || late_.empty();
    }
    if (late_.empty()) {
      found = std::move(first);
    } else {
      // The given model's residual is that of its own refit.
      found.nominal = std::move(first.nominal);
      found.refitted = std::move(first.refitted);
    }
    found.late = std::move(late_);
    dropWhatIsNot(found);
    warnOfTurn(found);
    found.warnings = std::move(warnings_);
    return found;
  }

 private:
  // For what one model lacks.
  MissingEffects search(const model::ModelDescription& model, std::span<const int> timed_joints) const {
    options_.report("columns", 0.0);
    MissingEffects search;
    const Dataset& data = recordings_.train;
    setModel(model, search);
    const std::vector<double> smoothing_rad_s = frictionSmoothing(*search.fitter, search.nominal);
    turnRound(model, smoothing_rad_s, search);
    const std::vector<std::string> kinds = consideredKinds(options_.effects);
    auto considered = recipes(data, model.mechanism, kinds, recordings_.channels, smoothing_rad_s);
    const bool only_drive = isOnlyDrive(data, model);
    std::erase_if(considered, [&](const auto& recipe) {
      return !holds(moving_, recipe->joint) ||
             (holds(timed_joints, recipe->joint) && isTiming(recipe->kind)) ||
             (only_drive && recipe->scales_all);
    });
    search.atoms = recipeAtoms(*search.fitter, considered);
    options_.report("search", 0.0);
    SelectionOptions selection = options_.selection();
    // Each joint has dry and viscous friction of its own, of which many a model has none.
    selection.most_effects += 2 * std::max(0, data.joints() - 2);
    selection.heldout = recordings_.heldout && options_.gates.heldout ? &*recordings_.heldout : nullptr;
    selection.progress = [this](double fraction) { options_.report("search", fraction); };
    search.selection = select(*search.fitter, search.atoms, search.nominal, selection);
    return search;
  }

  void setModel(const model::ModelDescription& model, MissingEffects& search) const {
    const Dataset& data = recordings_.train;
    search.fitter = std::make_unique<ModelFitter>(data, model, options_.fit());
    search.fitter->setRedundancy(redundancy(data, search.fitter->nominal(), options_.seed));
    search.nominal = search.fitter->nominal();
  }

  // How fast friction turns round is how a model is written, and not what its maker knows of the machine.
  // Declared friction turns round as the recording says, where that explains more.
  void turnRound(const model::ModelDescription& model, std::span<const double> smoothing_rad_s,
                 MissingEffects& search) const {
    MissingEffects turned;
    setModel(turningRoundAt(model, smoothing_rad_s), turned);
    const auto cost = [&](const ModelFit& fit) {
      return search.nominal.weighting->apply(fit.residual).squaredNorm() + fit.prior_residual.squaredNorm();
    };
    const double least = accepted::kContradicted * search.nominal.redundancy();
    if (cost(turned.nominal) + least < cost(search.nominal)) {
      search = std::move(turned);
    }
  }

  void warnOfTurn(const MissingEffects& found) {
    std::string turned;
    const model::ModelDescription used = found.fitter->describe(found.nominal);
    for (const model::EffectDescription& given : model_.effects) {
      for (const model::EffectDescription& effect : used.effects) {
        const std::optional<double> before = smoothingOf(given), after = smoothingOf(effect);
        if (effect.kind == given.kind && effect.joint == given.joint && before && *before != *after) {
          turned += fmt::format("{}joint {} at {:.2g} in place of {:.2g} rad/s", turned.empty() ? "" : ", ",
                                effect.joint + 1, *after, *before);
        }
      }
    }
    if (!turned.empty()) {
      warnings_.push_back("declared dry friction turns round at other velocities: " + turned);
    }
  }

  // On joints whose drive the first search has not timed already.
  std::vector<LateDrive> lateDrives(const MissingEffects& first) const {
    const auto& kinds = options_.effects;
    if (!kinds.empty() && std::none_of(kinds.begin(), kinds.end(), isTiming)) {
      return {};
    }
    std::vector<int> joints(moving_.begin(), moving_.end());
    std::erase_if(joints, [&](int joint) {
      const auto& terms = first.selection.fit.terms;
      return std::any_of(terms.begin(), terms.end(), [joint](const Term& term) {
        return term.recipe->joint == joint && isTiming(term.recipe->kind);
      });
    });
    std::vector<LateDrive> late =
        findLateDrives(recordings_.parts.train, first.fitter->describe(first.selection.fit), joints,
                       recordings_.resting, options_.fit(), options_.selection());
    std::erase_if(late, [&](const LateDrive& drive) { return !slowMotionAgrees(drive, first); });
    return late;
  }

  // A drive is as late in slow motion as in fast, where vibration of the structure may pass for a delay: what
  // was found explains slow motion as well beside it. Where it does not, slow motion is searched anew:
  // friction that turns round slowly may have made up for the drive. With more effects anything would agree.
  bool slowMotionAgrees(const LateDrive& late, const MissingEffects& first) const {
    model::ModelDescription model = model_;
    model.effects.push_back(late.effect);
    const ModelFit& fit = first.selection.fit;
    const auto explainsAsWell = [&](ModelFitter& fitter, const ModelFit& start) {
      return fitter.fit(start, *fit.weighting).objective - fit.objective <
             accepted::kContradicted * fit.redundancy();
    };
    ModelFitter fitter(recordings_.train, model, options_.fit());
    fitter.setRedundancy(fit.redundancy());
    if (explainsAsWell(fitter, fit)) {
      return true;
    }
    const MissingEffects timed = search(model, std::array{late.effect.joint});
    return timed.selection.fit.terms.size() <= fit.terms.size() &&
           explainsAsWell(*timed.fitter, timed.selection.fit);
  }

  // A delay that fast motion asks for shows in the error of data that were not fitted. True where one was
  // dropped.
  bool dropLateThatDoesNotHold(const MissingEffects& first, const MissingEffects& timed) {
    if (!recordings_.heldout || !options_.gates.heldout) {
      return false;
    }
    const Dataset& heldout = *recordings_.heldout;
    const auto errors = [&](const MissingEffects& search) {
      return residualOf(heldout, search.fitter->describe(search.selection.fit)).residual;
    };
    const Column without = errors(first);
    const Column with = errors(timed);
    return std::erase_if(late_, [&](const LateDrive& late) {
             const int joint = late.effect.joint;
             const bool shows =
                 jointRms(heldout, with, joint) < late_drive::kShows * jointRms(heldout, without, joint);
             if (!shows) {
               warnings_.push_back(
                   fmt::format("{}@{} explained fast motion, but not the held-out part: not added",
                               late.effect.kind, joint + 1));
             }
             return !shows;
           }) > 0;
  }

  void dropWhatIsNot(MissingEffects& found) {
    if (recordings_.heldout && options_.gates.heldout) {
      for (const std::string& label :
           dropWhatDoesNotHold(*found.fitter, found.selection, *recordings_.heldout)) {
        warnings_.push_back(label +
                            " explained a part of the recording, but not the held-out part: not added");
      }
    }
    for (const std::string& label : dropWhatIsNotEstablished(
             *found.fitter, found.selection, options_.bootstrap_replicates, options_.covarianceSeed())) {
      warnings_.push_back(label +
                          " explained a part of the recording, but its parameters are not known: not added");
    }
    if (options_.gates.rest) {
      found.outweighed = outweighedByRest(*found.fitter, found.selection, noise_Nm_);
    }
  }

  model::ModelDescription withLate() const {
    model::ModelDescription model = model_;
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

  const AnalysedRecordings& recordings_;
  const model::ModelDescription& model_;
  std::span<const int> moving_;
  std::span<const double> noise_Nm_;
  const DiagnoseOptions& options_;
  std::vector<LateDrive> late_;
  std::vector<std::string> warnings_;
};

}  // namespace

bool MissingEffects::namesAny() const {
  return !late.empty() || selection.fit.namesAny();
}

MissingEffects findMissing(const AnalysedRecordings& recordings, const model::ModelDescription& model,
                           std::span<const int> moving, std::span<const double> noise_Nm,
                           const DiagnoseOptions& options) {
  return Finder(recordings, model, moving, noise_Nm, options).find();
}

}  // namespace patella::diagnose
