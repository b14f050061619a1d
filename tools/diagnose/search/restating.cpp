#include "tools/diagnose/search/restating.hpp"

#include <algorithm>
#include <utility>

#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

Restating::Restating(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options,
                     Selection& selection)
    : fitter_(fitter),
      atoms_(atoms),
      options_(options),
      unit_(options.unit),
      cost_(parameterCost(selection.fit)),
      selection_(selection) {}

void Restating::nameRival(const std::string& label) {
  if (label != selection_.fit.terms.back().recipe->label()) {
    selection_.evidence.back().rivals = {label};
  }
}

void Restating::nameRival(const std::string& of, const std::string& rival) {
  for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
    if (!selection_.fit.terms[t].declared && selection_.fit.terms[t].recipe->label() == of) {
      selection_.evidence[t].rivals.push_back(rival);
    }
  }
}

bool Restating::isMissed(const ModelFit& smaller) const {
  return gainIsMissed(fitter_, smaller, selection_.fit) ||
         priorRelief(smaller, selection_.fit) >= accepted::kMoved;
}

std::optional<std::size_t> Restating::found(std::string_view kind, int joint) const {
  for (std::size_t t = 0; t < selection_.fit.terms.size(); ++t) {
    const Term& term = selection_.fit.terms[t];
    if (!term.declared && term.recipe->kind == kind && term.recipe->joint == joint) {
      return t;
    }
  }
  return std::nullopt;
}

ModelFit Restating::without(std::vector<std::size_t> terms) const {
  std::sort(terms.rbegin(), terms.rend());
  ModelFit fit = selection_.fit;
  std::size_t moved = 0;
  for (const std::size_t term : terms) {
    // Declared terms that come back stand first.
    const std::size_t back = fit.terms[term + moved].replaced.size();
    fit = withoutTerm(fit, term + moved);
    moved += back;
  }
  return fit;
}

std::optional<ModelFit> Restating::added(const ModelFit& fit, const Atom& atom,
                                         const std::vector<double>& nu) {
  std::optional<ModelFit> start = withCandidate(fitter_, fit, atom, Screened{});
  if (!start) {
    return std::nullopt;
  }
  start->terms.back().nu = nu;
  return fitter_.fit(std::move(*start), *selection_.fit.weighting);
}

double Restating::worth(const ModelFit& fit) const {
  double declared = 0.0;
  for (const Term& term : fit.terms) {
    declared += term.declared ? static_cast<double>(term.c.size() + term.nu.size()) : 0.0;
  }
  return fit.objective + unit_ * cost_ * (parametersInUse(fit) - declared);
}

}  // namespace patella::diagnose
