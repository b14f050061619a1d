#include "tools/diagnose/search/friction_restatement.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/restating.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

class FrictionRestatement : Restating {
 public:
  using Restating::Restating;

  bool changeOne() {
    return levelOut() || partFriction() || restateFriction() ||
           unite("coulomb_friction", "torque_bias", "asymmetric_friction") ||
           unite("coulomb_friction", "stribeck_friction", "stribeck_friction") ||
           unite("stribeck_friction", "torque_bias", "asymmetric_friction") || intoTwoLevels();
  }

 private:
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
      const ModelFit rest = fitter_.fit(without({low, high}), *selection_.fit.weighting);
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

  // Friction of two levels holds what a bias and more dry friction beside it say: they differ from it near
  // rest only, and share their sizes with it in any proportion. Presliding goes with them where it is not
  // worth its parameters. False where there is none of them.
  bool intoTwoLevels() {
    for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
      const Term& levels = selection_.fit.terms[t];
      if (levels.declared || levels.recipe->kind != "asymmetric_friction") {
        continue;
      }
      std::vector<std::size_t> beside = foundOf({"torque_bias", "coulomb_friction"}, levels.recipe->joint);
      if (const auto presliding = found("presliding_hysteresis", levels.recipe->joint)) {
        std::vector<std::size_t> all = beside;
        all.push_back(*presliding);
        if (holdAll(t, std::move(all), false)) {
          return true;
        }
      }
      if (!beside.empty() && holdAll(t, std::move(beside), true)) {
        return true;
      }
    }
    return false;
  }

  std::vector<std::size_t> foundOf(std::initializer_list<std::string_view> kinds, int joint) const {
    std::vector<std::size_t> all;
    for (const std::string_view kind : kinds) {
      if (const auto one = found(kind, joint)) {
        all.push_back(*one);
      }
    }
    return all;
  }

  // Puts a term in the place of itself and those beside it, where it explains nearly as much alone. What says
  // more is a rival then, or, unless `even_so`, stays. False where nothing is to be changed.
  bool holdAll(std::size_t term, std::vector<std::size_t> beside, bool even_so) {
    const Weighting& weighting = *selection_.fit.weighting;
    const std::string label = selection_.fit.terms[term].recipe->label();
    Column without_any = selection_.fit.residual + fitter_.torque(selection_.fit.terms[term]);
    std::string more = label;
    for (const std::size_t other : beside) {
      without_any += fitter_.torque(selection_.fit.terms[other]);
      more = selection_.fit.terms[other].recipe->kind + "+" + more;
    }
    const double explained =
        weighting.apply(without_any).squaredNorm() - weighting.apply(selection_.fit.residual).squaredNorm();
    ModelFit alone = fitter_.fit(without(std::move(beside)), weighting);
    const bool says_more = worth(selection_.fit) < worth(alone);
    if (!alone.at_edge.empty() || (says_more && !even_so) ||
        alone.objective - selection_.fit.objective > (1.0 - rivals::kNearlyAll) * explained) {
      return false;
    }
    adopt(selection_, std::move(alone), {});
    if (says_more) {
      nameRival(label, more);
    }
    return true;
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
      std::optional<ModelFit> best = added(without({low, high}), stribeck, place);
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
};

}  // namespace

bool restateFrictionOnce(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options,
                         Selection& selection) {
  return FrictionRestatement(fitter, atoms, options, selection).changeOne();
}

}  // namespace patella::diagnose
