#include "tools/diagnose/search/restatement.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/friction_restatement.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/search/restating.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// A few effects are restated in a few changes. More would be two ways to say the same, each of which the
/// other one follows.
constexpr int kMostChanges = 30;

class Restatement : Restating {
 public:
  using Restating::Restating;

  void run() {
    for (int changes = 0; changes < kMostChanges && changeOne(); ++changes) {
    }
  }

  // False where the found effect has no special case.
  bool usePlainer(std::size_t t) {
    const ModelFit rest = fitter_.fit(withoutTerm(selection_.fit, t), *selection_.fit.weighting);
    std::optional<ModelFit> best;
    eachSpecialCase(t, rest, [&](ModelFit simple) {
      if (!best || simple.objective < best->objective) {
        best = std::move(simple);
      }
    });
    if (!best) {
      return false;
    }
    const std::string wider = selection_.fit.terms[t].recipe->label();
    const Evidence before = selection_.evidence[t];
    const double share = (rest.objective - best->objective) / (rest.objective - selection_.fit.objective);
    adopt(selection_, std::move(*best),
          {.p_value = before.p_value, .gain = share * before.gain, .rivals = {}});
    nameRival(wider);
    return true;
  }

 private:
  // Those of a found effect, each fitted in its place. `rest`: the fit without the effect.
  template <class Use>
  void eachSpecialCase(std::size_t t, const ModelFit& rest, Use use) {
    const Term& term = selection_.fit.terms[t];
    for (const Atom& atom : atoms_.items) {
      const bool same =
          atom.recipe->kind == term.recipe->kind && atom.recipe->coefficients() >= term.c.size();
      if (same || !contains(*term.recipe, *atom.recipe) || !atom.recipe->nonlinear.empty() ||
          isContainedInOthers(*atom.recipe, t)) {
        continue;
      }
      std::optional<ModelFit> simple = added(rest, atom, atom.nu);
      if (simple && simple->at_edge.empty()) {
        use(std::move(*simple));
      }
    }
  }

  // False where nothing is to be changed.
  bool changeOne() { return simplify() || restateFrictionOnce(fitter_, atoms_, options_, selection_); }

  // Puts a special case in the place of what contains it, where the rest is not worth its parameters, or
  // where nobody would miss it: an early step did not know yet what the later ones found. What nobody would
  // miss, but has the evidence, is named as a possibility. False where all is as simple as it can be.
  bool simplify() {
    for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
      const Term& term = selection_.fit.terms[t];
      if (term.declared) {
        continue;
      }
      const ModelFit rest = fitter_.fit(withoutTerm(selection_.fit, t), *selection_.fit.weighting);
      // Others may say it all by now.
      std::optional<ModelFit> best;
      if (rest.at_edge.empty()) {
        best = rest;
      }
      bool special = false;
      eachSpecialCase(t, rest, [&](ModelFit simple) {
        if (!best || worth(simple) < worth(*best)) {
          best = std::move(simple);
          special = true;
        }
      });
      if (best && (worth(*best) < worth(selection_.fit) + simpler::kAsGood * unit_ ||
                   isOutOfRange(t, *best, rest) || !isMissed(*best))) {
        const std::string wider = term.recipe->label();
        const bool has_evidence = worth(*best) > worth(selection_.fit) && selection_.fit.at_edge.empty();
        adopt(selection_, std::move(*best),
              {.p_value = selection_.evidence[t].p_value, .gain = 0.0, .rivals = {}});
        if (special && has_evidence) {
          nameRival(wider);
        }
        return true;
      }
    }
    return false;
  }

  // Later steps have moved a parameter to where it means another effect, such as a spring's rest far from the
  // motion, and the simple one says nearly all.
  bool isOutOfRange(std::size_t term, const ModelFit& simple, const ModelFit& rest) const {
    const ModelFit& fit = selection_.fit;
    const std::string label = fit.terms[term].recipe->label();
    return std::any_of(fit.at_edge.begin(), fit.at_edge.end(),
                       [&](const Edge& edge) { return edge.label == label; }) &&
           simple.objective - fit.objective < simpler::kRest * (rest.objective - fit.objective);
  }

  bool isContainedInOthers(const Recipe& recipe, std::size_t but) const {
    for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
      const Term& term = selection_.fit.terms[t];
      if (t != but && !term.declared && contains(*term.recipe, recipe)) {
        return true;
      }
    }
    return false;
  }
};

}  // namespace

void restate(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options, Selection& selection) {
  Restatement(fitter, atoms, options, selection).run();
}

std::optional<Selection> withPlainer(ModelFitter& fitter, const Atoms& atoms, Selection selection,
                                     std::size_t term) {
  return Restatement(fitter, atoms, {}, selection).usePlainer(term) ? std::optional(std::move(selection))
                                                                    : std::nullopt;
}

}  // namespace patella::diagnose
