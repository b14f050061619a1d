#include "tools/diagnose/search/selection.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/search/restatement.hpp"
#include "tools/diagnose/search/rivals.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Text on a candidate that is beyond chance, but does not hold in every part of a recording.
constexpr const char* kUnsteady = "cross-validation";
constexpr const char* kUnstable = "stability";

/// Effects that a rival may take the place of, one after the other.
constexpr int kMostExchanges = 3;

// Margin above which a candidate's p (exceedance) is below `level`. `chance` is sorted.
double leastMargin(const std::vector<double>& chance, double level) {
  const auto draws = static_cast<double>(chance.size());
  const double may_reach = std::max(0.0, std::ceil(level * (1.0 + draws) - 1.0) - 1.0);
  return chance[chance.size() - 1 - static_cast<std::size_t>(std::min(may_reach, draws - 1.0))];
}

class Selector {
 public:
  Selector(ModelFitter& fitter, const Atoms& atoms, const ModelFit& nominal, const SelectionOptions& options)
      : fitter_(fitter), atoms_(atoms), options_(options), cost_(parameterCost(nominal)) {
    result_.fit = nominal;
    result_.evidence.resize(nominal.terms.size());
  }

  Selection run() {
    for (int step = 0; step < options_.most_effects && (forward(accepted::kFamilyWiseP) || forwardApart());
         ++step) {
      backward();
      report(static_cast<double>(step + 1) / options_.most_effects);
    }
    for (int exchanges = 0;; ++exchanges) {
      restate(fitter_, atoms_, {.unit = unit_, .replicates = options_.replicates, .seed = options_.seed},
              result_);
      if (!findRivals(fitter_, atoms_,
                      {.unit = unit_,
                       .seed = options_.seed,
                       .heldout = options_.heldout,
                       .may_exchange = exchanges < kMostExchanges},
                      result_)) {
        break;
      }
    }
    return std::move(result_);
  }

 private:
  void report(double fraction) const {
    if (options_.progress) {
      options_.progress(fraction);
    }
  }

  // What two joints lack alike passes for noise that they share, beside which an effect on one of them
  // explains nothing. So joints that leave much the same are looked at one by one, too, unless a person is
  // known to push them.
  bool forwardApart() {
    const Weighting& together = *result_.fit.weighting;
    if (options_.pushed || fitter_.data().joints() == 1 || together.correlation() <= accepted::kJointsAlike ||
        !restIsMissed(fitter_, result_.fit)) {
      return false;
    }
    Selection before = result_;
    result_.fit = fitter_.fit(std::move(result_.fit), together.jointByJoint());
    if (forward(unknown::kLevelOfSecondLook * accepted::kFamilyWiseP)) {
      return true;
    }
    result_ = std::move(before);
    return false;
  }

  // False where nothing is accepted by chance of `family_wise_p`, over all candidates together.
  bool forward(double family_wise_p) {
    const ModelFit& current = result_.fit;
    if (!restIsMissed(fitter_, current) && !knownIsMoved(current)) {
      return false;
    }
    const Screening screening(
        fitter_.data(), current, atoms_,
        {.replicates = options_.replicates, .seed = options_.seed + 7919 * result_.steps.size()});
    std::vector<Candidate> candidates = rank(atoms_, screening, cost_);
    std::erase_if(candidates,
                  [&](const Candidate& candidate) { return isContained(*candidate.atom->recipe); });
    const auto statistic = [cost = cost_](double gain, int dimensions) { return gain - cost * dimensions; };
    std::vector<double> chance = screening.chance(statistic);
    std::sort(chance.begin(), chance.end());
    const double threshold = leastMargin(chance, family_wise_p);

    Candidate* best = fitBest(fitter_, current, cost_, candidates);
    double p_value = best != nullptr ? judge(*best, chance, family_wise_p) : 1.0;
    if (best != nullptr && !best->refused_because.empty()) {
      Candidate* clearer =
          fitClearer(current, candidates, std::max(threshold, accepted::kClearer * best->margin));
      if (clearer != nullptr) {
        best = clearer;
        p_value = judge(*best, chance, family_wise_p);
      }
    }
    SelectionStep step = describeStep(candidates, threshold, cost_);
    step.p_value = p_value;
    step.chance = threshold;
    const bool accepted = best != nullptr && best->refused_because.empty();
    if (accepted) {
      step.ranking[static_cast<std::size_t>(best - candidates.data())].accepted = true;
      step.accepted = best->atom->label;
      accept(*best, p_value);
    }
    std::sort(step.ranking.begin(), step.ranking.end(), [](const auto& a, const auto& b) {
      return std::tie(b.gain, a.label) < std::tie(a.gain, b.label);
    });
    result_.steps.push_back(std::move(step));
    return accepted;
  }

  // There already, or a special case of what is there.
  bool isContained(const Recipe& recipe) const {
    return std::any_of(result_.fit.terms.begin(), result_.fit.terms.end(), [&](const Term& term) {
      return !term.declared && (isSame(*term.recipe, recipe) || shapesTheSame(*term.recipe, recipe) ||
                                (term.recipe->kind != recipe.kind && contains(*term.recipe, recipe)));
    });
  }

  // Its p. A gate may refuse it.
  double judge(Candidate& candidate, const std::vector<double>& chance, double family_wise_p) {
    const double p_value = exceedance(chance, candidate.margin);
    candidate.refused_because = gate(candidate, p_value, family_wise_p);
    if (candidate.refused_because == kUnsteady || candidate.refused_because == kUnstable) {
      noteUnsteady(candidate, p_value);
    }
    return p_value;
  }

  // Only position and velocity count: a person's push comes and goes with time, activation and torque.
  void noteUnsteady(const Candidate& candidate, double p_value) {
    const Recipe& recipe = *candidate.atom->recipe;
    const std::string_view variable = betrayingVariable(recipe.kind);
    if (variable != "q" && variable != "dq") {
      return;
    }
    const double explained =
        std::max(0.0, squareOf(result_.fit, recipe.joint) - squareOf(*candidate.fit, recipe.joint));
    result_.unsteady =
        Dependence{.joint = recipe.joint,
                   .variable = fmt::format("{}{}", variable, recipe.joint + 1),
                   .explained_Nm = std::sqrt(explained / static_cast<double>(fitter_.data().rows())),
                   .p_value = p_value};
  }

  // The best explanation need not be the least likely one by chance: where noise is slow, slow torque counts
  // for little. Returns a candidate of which screening and fit say more than `margin`.
  Candidate* fitClearer(const ModelFit& current, std::vector<Candidate>& candidates, double margin) {
    const auto isClearer = [&](Candidate& candidate) {
      if (candidate.refused_because.empty() && !candidate.fit &&
          candidate.screened->gain - cost_ * candidate.screened->dimensions > margin) {
        fitCandidate(fitter_, current, cost_, candidate);
      }
      return candidate.refused_because.empty() && candidate.fit && candidate.margin > margin;
    };
    const auto clearer = std::find_if(candidates.begin(), candidates.end(), isClearer);
    return clearer == candidates.end() ? nullptr : &*clearer;
  }

  double squareOf(const ModelFit& fit, int joint) const {
    const Eigen::Index rows = fitter_.data().rows();
    return fit.residual.segment(joint * rows, rows).squaredNorm();
  }

  // The largest share of the mean square left of a joint's torque that goes.
  double shareOf(const ModelFit& larger) const {
    double share = 0.0;
    for (int joint = 0; joint < fitter_.data().joints(); ++joint) {
      const double before = squareOf(result_.fit, joint);
      share = std::max(share, before > 0.0 ? 1.0 - squareOf(larger, joint) / before : 0.0);
    }
    return share;
  }

  bool isMaterial(const ModelFit& larger, double least_share) const {
    return shareOf(larger) >= least_share && gainIsMissed(fitter_, result_.fit, larger);
  }

  std::string gate(const Candidate& candidate, double p_value, double family_wise_p) const {
    const bool hump = candidate.atom->recipe->kind == "tremor" && candidate.gain < accepted::kClearLine;
    if (options_.gates.share &&
        !isMaterial(*candidate.fit, hump ? accepted::kLeastTremorShare : accepted::kLeastShare) &&
        priorRelief(result_.fit, *candidate.fit) < accepted::kMoved) {
      return "too little";
    }
    if (options_.gates.chance && p_value >= family_wise_p) {
      return "chance";
    }
    if (!options_.gates.cross_validation && !options_.gates.stability) {
      return {};
    }
    const Blockwise blocks(result_.fit, *candidate.fit);
    if (options_.gates.cross_validation && !blocks.foreseen()) {
      return kUnsteady;
    }
    if (options_.gates.stability &&
        !blocks.isStable(candidate.unit * (candidate.gain - candidate.margin), options_.seed)) {
      return kUnstable;
    }
    return {};
  }

  void accept(Candidate& best, double p_value) {
    // The residual is nearer to the noise now: weighted by it, everything is fitted once more.
    const Eigen::VectorXd residual = best.fit->residual;
    fitter_.setRedundancy(redundancy(fitter_.data(), *best.fit, kUnitSeed));
    adopt(result_, fitter_.fit(std::move(*best.fit), Weighting(fitter_.data(), residual)),
          {.p_value = p_value, .gain = best.gain, .rivals = {}});
    unit_ = best.unit;
  }

  ModelFit without(std::size_t term) {
    return fitter_.fit(withoutTerm(result_.fit, term), *result_.fit.weighting);
  }

  // Drops what later additions have made superfluous.
  void backward() {
    for (std::size_t t = 0; t < result_.fit.terms.size();) {
      const Term& term = result_.fit.terms[t];
      if (term.declared || t + 1 == result_.fit.terms.size()) {
        ++t;
        continue;
      }
      ModelFit smaller = without(t);
      const double gain = (smaller.objective - result_.fit.objective) / unit_;
      if (gain < cost_ * (parameters(result_.fit) - parameters(smaller))) {
        const std::size_t back = term.replaced.size();
        adopt(result_, std::move(smaller), {});
        t += back;
      } else {
        result_.evidence[t].gain = gain;
        ++t;
      }
    }
  }

  ModelFitter& fitter_;
  const Atoms& atoms_;
  const SelectionOptions& options_;
  double cost_;
  double unit_ = 1.0;  ///< of the last accepted candidate
  Selection result_;
};

}  // namespace

Selection select(ModelFitter& fitter, const Atoms& atoms, const ModelFit& nominal,
                 const SelectionOptions& options) {
  return Selector(fitter, atoms, nominal, options).run();
}

void adopt(Selection& selection, ModelFit fit, const Evidence& of_new) {
  const std::vector<Term>& old = selection.fit.terms;
  std::vector<Evidence> evidence;
  for (const Term& term : fit.terms) {
    const auto same =
        std::find_if(old.begin(), old.end(), [&](const Term& t) { return t.recipe == term.recipe; });
    evidence.push_back(same != old.end() ? selection.evidence[static_cast<std::size_t>(same - old.begin())]
                       : term.declared   ? Evidence{}
                                         : of_new);
  }
  selection.fit = std::move(fit);
  selection.evidence = std::move(evidence);
}

Selection withoutTerm(ModelFitter& fitter, const Selection& selection, std::size_t term) {
  Selection smaller = selection;
  adopt(smaller, fitter.fit(withoutTerm(selection.fit, term), *selection.fit.weighting), {});
  return smaller;
}

}  // namespace patella::diagnose
