#include "tools/diagnose/search/exchange.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/search/candidate.hpp"

namespace patella::diagnose {
namespace {

// The best fit with the effect of that label, from wherever on its grid it starts; empty where it has none
// within its range.
std::optional<ModelFit> withEffect(ModelFitter& fitter, const Atoms& atoms, const ModelFit& smaller,
                                   const std::string& label) {
  std::optional<ModelFit> best;
  for (const Atom& atom : atoms.items) {
    std::optional<ModelFit> start =
        atom.label == label ? withCandidate(fitter, smaller, atom, Screened{}) : std::nullopt;
    if (!start) {
      continue;
    }
    ModelFit fit = fitter.fit(std::move(*start), *smaller.weighting);
    if (fit.at_edge.empty() && (!best || fit.objective < best->objective)) {
      best = std::move(fit);
    }
  }
  return best;
}

// "a+b@1": a@1 and b@1.
std::vector<std::string> effectsOf(const std::string& rival) {
  const std::size_t end = rival.find('@');
  std::vector<std::string> labels;
  for (std::size_t first = 0; first < end;) {
    const std::size_t next = std::min(rival.find('+', first), end);
    labels.push_back(rival.substr(first, next - first) + rival.substr(end));
    first = next + 1;
  }
  return labels;
}

}  // namespace

void exchange(ModelFitter& fitter, ModelFit better, std::size_t place, Selection& selection) {
  Evidence own = selection.evidence[place];
  own.rivals.clear();
  const Recipe& before = *selection.fit.terms[place].recipe;
  const Recipe& now = *better.terms.back().recipe;
  if (contains(before, now) && before.label() != now.label()) {
    own.rivals.push_back(before.label());
  }
  const Weighting weighting(fitter.data(), better.residual);
  adopt(selection, fitter.fit(std::move(better), weighting), own);
}

std::vector<Selection> withRivals(ModelFitter& fitter, const Atoms& atoms, const Selection& selection) {
  std::vector<Selection> all;
  for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
    for (const std::string& rival : selection.evidence[t].rivals) {
      const std::vector<std::string> labels = effectsOf(rival);
      std::optional<ModelFit> fit = fitter.fit(withoutTerm(selection.fit, t), *selection.fit.weighting);
      for (const std::string& label : labels) {
        fit = fit ? withEffect(fitter, atoms, *fit, label) : std::nullopt;
      }
      if (!fit) {
        continue;
      }
      Selection other = selection;
      Evidence own = other.evidence[t];
      if (labels.size() == 1) {
        std::replace(own.rivals.begin(), own.rivals.end(), rival, selection.fit.terms[t].recipe->label());
      } else {
        own.rivals.clear();
      }
      const Weighting weighting(fitter.data(), fit->residual);
      adopt(other, fitter.fit(std::move(*fit), weighting), own);
      all.push_back(std::move(other));
    }
  }
  return all;
}

}  // namespace patella::diagnose
