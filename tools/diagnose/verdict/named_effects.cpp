#include "tools/diagnose/verdict/named_effects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/search/correlations.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/free_function.hpp"
#include "tools/diagnose/search/late_drive.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/search/outweighed.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/findings.hpp"
#include "tools/diagnose/verdict/runaways.hpp"
#include "tools/diagnose/verdict/unknown_rest.hpp"
#include "tools/diagnose/verdict/wandering_tremor.hpp"

namespace patella::diagnose {
namespace {

void addSelected(const MissingEffects& found, const Eigen::MatrixXd& covariance,
                 const std::vector<FreeFunction>& free, int joints, std::vector<EffectFinding>& effects) {
  const ModelFit& fit = found.selection.fit;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    if (term.declared) {
      continue;
    }
    effects.push_back(findingOf(fit, covariance, t, found.selection.evidence[t], joints));
    if (std::find(found.outweighed.begin(), found.outweighed.end(), term.recipe.get()) !=
        found.outweighed.end()) {
      effects.back().not_asserted_because = kOutweighedWords;
    }
    for (const FreeFunction& function : free) {
      if (function.holds(t)) {
        effects.back().not_asserted_because =
            "any function of " + function.dependence.variable + " explains as much";
      }
    }
  }
}

double meanSquareOf(const EffectFinding& tremor) {
  return 0.5 * std::pow(tremor.parameters.front().value, 2);
}

// A line in the spectrum of what is left, against all else that is left.
bool outweighed(const EffectFinding& tremor, const JointRest& left) {
  const double own = meanSquareOf(tremor);
  const double rest = left.left_Nm * left.left_Nm - left.noise_Nm * left.noise_Nm - own;
  return own < asserted::kOverRest * asserted::kOverRest * rest;
}

void addTremors(const AnalysedRecordings& recordings, const model::ModelDescription& extended,
                std::span<const double> least_Nm, std::span<const JointRest> rests,
                const DiagnoseOptions& options, Diagnosis& diagnosis) {
  const auto& kinds = options.effects;
  const bool considered = kinds.empty() || std::find(kinds.begin(), kinds.end(), "tremor") != kinds.end();
  if (!considered) {
    return;
  }
  for (EffectFinding& tremor : wanderingTremors(recordings.wide, extended, diagnosis.effects)) {
    const auto joint = static_cast<std::size_t>(tremor.joint);
    if (meanSquareOf(tremor) < least_Nm[joint] * least_Nm[joint]) {
      continue;
    }
    if (options.gates.rest && outweighed(tremor, rests[joint])) {
      tremor.not_asserted_because = kOutweighedWords;
    }
    diagnosis.warnings.push_back(
        fmt::format("the phase of joint {}'s tremor wanders: it is named, but not added to the model, which "
                    "could not foresee it",
                    tremor.joint + 1));
    diagnosis.effects.push_back(std::move(tremor));
  }
}

// Motion alone does not tell a drive that is late from a column that is early.
void warnOfEarlyColumns(Diagnosis& diagnosis) {
  for (const EffectFinding& effect : diagnosis.effects) {
    if (isTiming(effect.kind) && effect.asserted()) {
      diagnosis.warnings.push_back(fmt::format(
          "joint {}: a drive that acts {:.2g} ms late, and columns of position or velocity that come as "
          "much later than that of torque, as through a filter, look alike; check the columns",
          effect.joint + 1, 1e3 * effect.parameters.front().value));
    }
  }
}

// The share of found effects includes that of the declared ones that they replaced.
Eigen::VectorXd missingTorque(MissingEffects& found) {
  Eigen::VectorXd residual = found.nominal.residual;
  for (const Term& term : found.selection.fit.terms) {
    for (const Term& replaced : term.replaced) {
      residual += found.fitter->torque(replaced);
    }
  }
  return residual;
}

struct Beside {
  double square_Nm2 = 0.0;    ///< mean on its joint that the effect explains beside all others
  double prior_relief = 0.0;  ///< see priorRelief(): parameters' distance from what is known, without it
};

// Nothing where the fit does not have the effect.
std::optional<Beside> besideOthers(const EffectFinding& effect, const Dataset& data, MissingEffects& found) {
  if (effect.kind == "tremor") {
    return Beside{.square_Nm2 = meanSquareOf(effect)};
  }
  const std::vector<Term>& terms = found.selection.fit.terms;
  const auto term = std::find_if(terms.begin(), terms.end(), [&](const Term& own) {
    return !own.declared && own.recipe->kind == effect.kind && own.recipe->joint == effect.joint;
  });
  if (term == terms.end()) {
    return {};
  }
  const Selection without =
      withoutTerm(*found.fitter, found.selection, static_cast<std::size_t>(term - terms.begin()));
  return Beside{.square_Nm2 = std::pow(jointRms(data, without.fit.residual, effect.joint), 2) -
                              std::pow(jointRms(data, found.selection.fit.residual, effect.joint), 2),
                .prior_relief = priorRelief(without.fit, found.selection.fit)};
}

// Whether anybody would look for an effect that is only possible: for what it explains beside the others, or
// for what the model's parameters would take up in its place.
bool mayMatter(const EffectFinding& effect, const Dataset& data, MissingEffects& found) {
  const double least_Nm = leastUnnamed_Nm(*found.fitter)[static_cast<std::size_t>(effect.joint)];
  const std::optional<Beside> beside = besideOthers(effect, data, found);
  return !beside || beside->square_Nm2 > least_Nm * least_Nm || beside->prior_relief >= accepted::kMoved;
}

// Whether it is no more than what an estimate of the cause may leave of it.
bool mayBeOfCause(const EffectFinding& effect, std::span<const double> cause_Nm, const Dataset& data,
                  MissingEffects& found) {
  if (cause_Nm.empty()) {
    return false;
  }
  const double least_Nm = shared::kLeftOfCause * cause_Nm[static_cast<std::size_t>(effect.joint)];
  const std::optional<Beside> beside = besideOthers(effect, data, found);
  return beside && beside->square_Nm2 < least_Nm * least_Nm;
}

// Whether a drive is late by less than a reader of columns may be.
bool mayBeTiming(const EffectFinding& effect, std::span<const Recording> recordings) {
  return isTiming(effect.kind) && effect.parameters.front().value < leastLateness_s(recordings);
}

// What counts for nothing beside masses that may be others is not outweighed by a rest that is noise.
void nameTakenByMasses(std::span<const JointRest> rests, std::vector<EffectFinding>& effects) {
  for (EffectFinding& effect : effects) {
    const JointRest& rest = rests[static_cast<std::size_t>(effect.joint)];
    if (effect.not_asserted_because == kOutweighedWords && effect.kind != "tremor" &&
        rest.structure_Nm() <= unknown::kLikeNoise * rest.noise_Nm) {
      effect.not_asserted_because = kTakenUpWords;
    }
  }
}

void nameDoubtful(const AnalysedRecordings& recordings, std::span<const double> cause_Nm,
                  MissingEffects& found, std::vector<EffectFinding>& effects) {
  const Dataset& data = recordings.train;
  for (EffectFinding& effect : effects) {
    if (!effect.asserted()) {
      continue;
    }
    if (strengthIsUnknown(effect)) {
      effect.not_asserted_because = kUnknownStrengthWords;
    } else if (mayBeTiming(effect, recordings.parts.train)) {
      effect.not_asserted_because = kMayBeTimingWords;
    } else if (mayBeOfCause(effect, cause_Nm, data, found)) {
      effect.not_asserted_because = kMayBeOfCauseWords;
    } else if (periodsAreUnknown(effect, rangeOf(data, effect.joint))) {
      effect.not_asserted_because = kUnknownPeriodsWords;
    } else if (mayBeAnother(effect)) {
      effect.not_asserted_because = kMayBeAnotherWords;
    }
  }
}

}  // namespace

void nameEffects(const AnalysedRecordings& recordings, MissingEffects& found, const UnexplainedRest& rest,
                 const DiagnoseOptions& options, std::span<const double> cause_Nm, Diagnosis& diagnosis) {
  const Dataset& data = recordings.train;
  const Selection& selection = found.selection;
  diagnosis.steps = selection.steps;
  diagnosis.unexplained = rest.dependences;
  const Eigen::MatrixXd covariance =
      withRest(widerCovariance(data, selection.fit, options.bootstrap_replicates, options.covarianceSeed()),
               data, selection.fit, rest.joints);
  const std::vector<FreeFunction> free = freeFunctions(data, selection);
  addSelected(found, covariance, free, data.joints(), diagnosis.effects);
  for (const LateDrive& late : found.late) {
    diagnosis.effects.push_back(
        findingOf(late.effect.kind, late.effect.joint, {late.estimate}, late.evidence, data.joints()));
  }
  addConfoundsBetween(diagnosis.effects);
  addTremors(recordings, found.fitter->describe(selection.fit), found.fitter->leastTorque_Nm(), rest.joints,
             options, diagnosis);
  // An effect that comes and goes, or is of another shape than any of the library, is not nothing.
  if (diagnosis.effects.empty() && diagnosis.unexplained.empty() && selection.unsteady) {
    diagnosis.unexplained.push_back(*selection.unsteady);
  }
  const bool unexplained = restIsUnknown(data, {.missing = missingTorque(found), .left = rest.whole.residual},
                                         diagnosis.effects, diagnosis.unexplained);
  for (const FreeFunction& function : free) {
    diagnosis.unexplained.insert(diagnosis.unexplained.begin(), function.dependence);
  }
  if (unexplained || !free.empty()) {
    diagnosis.doubts.push_back({Doubt::kUnexplained, {}});
  }
  nameDoubtful(recordings, cause_Nm, found, diagnosis.effects);
  nameTakenByMasses(rest.joints, diagnosis.effects);
  if (std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const EffectFinding& effect) {
        return !effect.asserted() && effect.not_asserted_because != kMayBeTimingWords &&
               effect.not_asserted_because != kMayBeOfCauseWords && mayMatter(effect, data, found);
      })) {
    diagnosis.doubts.push_back({Doubt::kOutweighed,
                                "What was found is no more than what stays unexplained or the model's own "
                                "parameters could be, or of unknown size: it may be a part of something else "
                                "that is missing."});
  }
  warnOfEarlyColumns(diagnosis);
  diagnosis.nominal = refittedParameters(*found.fitter, selection.fit, covariance);
  if (std::string moved = beyondTolerance(diagnosis); !moved.empty()) {
    diagnosis.doubts.push_back({Doubt::kParametersMoved, std::move(moved)});
  }
  std::vector<std::string> names;
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    names.push_back(parameter.name);
  }
  diagnosis.correlations = correlationsOf(
      selection.fit, names, found.fitter->mechanism().namedSlopes(selection.fit.mechanism), covariance);
}

}  // namespace patella::diagnose
