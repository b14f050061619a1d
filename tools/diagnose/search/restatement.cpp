#include "tools/diagnose/search/restatement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// A few effects are restated in a few changes. More would be two ways to say the same, each of which the
/// other one follows.
constexpr int kMostChanges = 30;

class Restatement {
 public:
  Restatement(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options, Selection& selection)
      : fitter_(fitter),
        atoms_(atoms),
        options_(options),
        unit_(options.unit),
        cost_(parameterCost(selection.fit)),
        selection_(selection) {}

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
  bool changeOne() {
    return simplify() || levelOut() || partFriction() || restateFriction() ||
           unite("coulomb_friction", "torque_bias", "asymmetric_friction") ||
           unite("coulomb_friction", "stribeck_friction", "stribeck_friction") ||
           unite("stribeck_friction", "torque_bias", "asymmetric_friction");
  }

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

  // Of the last term. Another variant of the same kind has its name, and is no other answer.
  void nameRival(const std::string& label) {
    if (label != selection_.fit.terms.back().recipe->label()) {
      selection_.evidence.back().rivals = {label};
    }
  }

  // What the selection has beyond a smaller fit.
  bool isMissed(const ModelFit& smaller) const {
    return gainIsMissed(fitter_, smaller, selection_.fit) ||
           priorRelief(smaller, selection_.fit) >= accepted::kMoved;
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

  std::optional<std::size_t> found(std::string_view kind, int joint) const {
    for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
      const Term& term = selection_.fit.terms[t];
      if (!term.declared && term.recipe->kind == kind && term.recipe->joint == joint) {
        return t;
      }
    }
    return std::nullopt;
  }

  // Two findings that are one. Dry friction and a bias are dry friction of two levels, but for how it turns
  // round near rest, where nothing is measured well; the peak of Stribeck's is there, too. Dry friction and
  // what comes on top of it near rest are Stribeck's. Two that say more stay a possibility. False where
  // nothing is to be united.
  bool unite(std::string_view first, std::string_view second, std::string_view both) {
    for (const Atom& atom : atoms_.items) {
      const Recipe& recipe = *atom.recipe;
      if (recipe.kind != both || recipe.coefficients() != 2) {
        continue;
      }
      const auto one = found(first, recipe.joint);
      const auto other = found(second, recipe.joint);
      if (!one || !other) {
        continue;
      }
      const auto [low, high] = std::minmax(*one, *other);
      const double p_value = std::max(selection_.evidence[low].p_value, selection_.evidence[high].p_value);
      const ModelFit rest = fitter_.fit(without(low, high), *selection_.fit.weighting);
      const Term& second_term = selection_.fit.terms[*other];
      std::optional<ModelFit> united =
          added(rest, atom, second_term.recipe->kind == both ? second_term.nu : atom.nu);
      // Stribeck's peak is one thing that differs near rest, and how two levels turn round another.
      const bool peak = first == "stribeck_friction";
      const double nearly_all = peak ? rivals::kNearlyAll * rivals::kNearlyAll : rivals::kNearlyAll;
      if (!united || !united->at_edge.empty() ||
          rest.objective - united->objective < nearly_all * (rest.objective - selection_.fit.objective)) {
        continue;
      }
      const bool says_more = peak && worth(selection_.fit) < worth(*united);
      adopt(selection_, std::move(*united), {.p_value = p_value, .gain = 0.0, .rivals = {}});
      if (says_more) {
        nameRival(fmt::format("{}+{}@{}", first, second, recipe.joint + 1));
      }
      return true;
    }
    return false;
  }

  // Two levels of friction that were found before Stribeck's peak may have stood for it: Stribeck's friction
  // beside a bias and viscous friction, or without, takes their place where it says about the same in no more
  // words. False where there is none.
  bool restateFriction() {
    for (const Atom& stribeck : atoms_.items) {
      if (stribeck.recipe->kind != "stribeck_friction") {
        continue;
      }
      const auto levels = found("asymmetric_friction", stribeck.recipe->joint);
      const auto peak = found("stribeck_friction", stribeck.recipe->joint);
      if (!levels || !peak) {
        continue;
      }
      const auto [low, high] = std::minmax(*levels, *peak);
      const double p_value = std::max(selection_.evidence[low].p_value, selection_.evidence[high].p_value);
      const std::vector<double> place = selection_.fit.terms[*peak].nu;
      std::optional<ModelFit> best = added(without(low, high), stribeck, place);
      if (!best) {
        continue;
      }
      for (bool more = true; more;) {
        more = false;
        for (const Atom& atom : atoms_.items) {
          if (atom.recipe->joint != stribeck.recipe->joint || !atom.recipe->nonlinear.empty() ||
              (atom.recipe->kind != "viscous_friction" && atom.recipe->kind != "torque_bias")) {
            continue;
          }
          // Without the other effect the peak may have run away.
          ModelFit again = *best;
          for (Term& term : again.terms) {
            term.nu = term.recipe->label() == stribeck.recipe->label() ? place : term.nu;
          }
          std::optional<ModelFit> larger = added(again, atom, atom.nu);
          if (larger && worth(*larger) < worth(*best)) {
            best = std::move(larger);
            more = true;
          }
        }
      }
      if (best->at_edge.empty() && worth(*best) <= worth(selection_.fit) + unit_) {
        adopt(selection_, std::move(*best), {.p_value = p_value, .gain = 0.0, .rivals = {}});
        return true;
      }
    }
    return false;
  }

  // Friction of two levels that may as well be one is dry friction: a person's mean push moves one level up
  // and the other down, which counts for more than the information criterion knows. False where there is
  // none.
  bool levelOut() {
    for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
      const Term& term = selection_.fit.terms[t];
      if (term.declared || term.recipe->kind != "asymmetric_friction" || term.c.size() != 2) {
        continue;
      }
      if (directionsDiffer(t)) {
        continue;
      }
      const Atom* plain = plainAtom("coulomb_friction", term.recipe->joint);
      std::optional<ModelFit> level =
          plain != nullptr ? added(withoutTerm(selection_.fit, t), *plain, plain->nu) : std::nullopt;
      if (level && level->at_edge.empty()) {
        adopt(selection_, std::move(*level),
              {.p_value = selection_.evidence[t].p_value, .gain = 0.0, .rivals = {}});
        return true;
      }
    }
    return false;
  }

  // Whether what a friction has in one direction differs from what it has in the other, pair by pair of its
  // coefficients.
  bool directionsDiffer(std::size_t t) {
    const Term& term = selection_.fit.terms[t];
    const auto size = static_cast<Eigen::Index>(term.c.size());
    const Eigen::Index at = selection_.fit.offset[t];
    const Eigen::MatrixXd covariance =
        widerCovariance(fitter_.data(), selection_.fit, options_.replicates, options_.seed)
            .block(at, at, size, size);
    for (Eigen::Index i = 0; i + 1 < size; i += 2) {
      const double variance = covariance(i, i) + covariance(i + 1, i + 1) - 2.0 * covariance(i, i + 1);
      const auto k = static_cast<std::size_t>(i);
      if (std::pow(term.c[k] - term.c[k + 1], 2) > simpler::kTwoLevels * simpler::kTwoLevels * variance) {
        return true;
      }
    }
    return false;
  }

  // Without a shape of its own.
  const Atom* plainAtom(std::string_view kind, int joint) const {
    const auto plain = std::find_if(atoms_.items.begin(), atoms_.items.end(), [&](const Atom& atom) {
      return atom.recipe->kind == kind && atom.recipe->joint == joint && atom.recipe->nonlinear.empty();
    });
    return plain == atoms_.items.end() ? nullptr : &*plain;
  }

  // Dry and viscous friction in the place of friction of two levels and two dampings; empty for other terms.
  std::optional<ModelFit> asPlainFriction(std::size_t index) {
    const Term& term = selection_.fit.terms[index];
    if (term.declared || term.recipe->kind != "asymmetric_friction" || term.c.size() <= 2) {
      return std::nullopt;
    }
    std::optional<ModelFit> plain = withoutTerm(selection_.fit, index);
    for (const std::string_view kind : {"coulomb_friction", "viscous_friction"}) {
      const Atom* simple = plainAtom(kind, term.recipe->joint);
      plain = plain && simple != nullptr ? added(*plain, *simple, simple->nu) : std::nullopt;
    }
    return plain && plain->at_edge.empty() ? std::move(plain) : std::nullopt;
  }

  // Friction of two levels and two dampings that are not worth their number, or may as well be one and one,
  // is dry and viscous friction, which most machines have. False where there is none.
  bool partFriction() {
    for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
      std::optional<ModelFit> plain = asPlainFriction(t);
      if (plain && (worth(*plain) < worth(selection_.fit) || !directionsDiffer(t) || !isMissed(*plain))) {
        const Evidence& before = selection_.evidence[t];
        adopt(selection_, std::move(*plain),
              {.p_value = before.p_value,
               .gain = before.gain,
               .rivals = {selection_.fit.terms[t].recipe->label()}});
        return true;
      }
    }
    return false;
  }

  // The terms without two of them, the lower first; not fitted.
  ModelFit without(std::size_t low, std::size_t high) const {
    // Declared terms that come back stand first.
    const std::size_t moved = low + selection_.fit.terms[high].replaced.size();
    return withoutTerm(withoutTerm(selection_.fit, high), moved);
  }

  // The fit with one more effect; empty where that gives nothing of its own.
  std::optional<ModelFit> added(const ModelFit& fit, const Atom& atom, const std::vector<double>& nu) {
    std::optional<ModelFit> start = withCandidate(fitter_, fit, atom, Screened{});
    if (!start) {
      return std::nullopt;
    }
    start->terms.back().nu = nu;
    return fitter_.fit(std::move(*start), *selection_.fit.weighting);
  }

  // Residual of a fit plus the cost of its parameters, without those that the model had already.
  double worth(const ModelFit& fit) const {
    double declared = 0.0;
    for (const Term& term : fit.terms) {
      declared += term.declared ? static_cast<double>(term.c.size() + term.nu.size()) : 0.0;
    }
    return fit.objective + unit_ * cost_ * (parametersInUse(fit) - declared);
  }

  ModelFitter& fitter_;
  const Atoms& atoms_;
  const RestateOptions& options_;
  double unit_;
  double cost_;
  Selection& selection_;
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
