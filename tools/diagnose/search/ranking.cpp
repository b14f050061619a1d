#include "tools/diagnose/search/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/diagnose/effects/recipe_names.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/rugged_start.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Candidates of a step that are fitted in full: the best of the screening, so many at most, as long as what
/// their columns explain comes near the best fit so far.
constexpr std::size_t kFittedCandidates = 10;

// The coefficient that the screening, which knows no signs, would make most of where physics does not allow
// its sign; empty where there is none.
std::string wrongSign(ModelFitter& fitter, const Candidate& candidate) {
  const Recipe& recipe = *candidate.atom->recipe;
  const Eigen::MatrixXd basis = fitter.basis(recipe, candidate.atom->nu);
  std::string name;
  double largest = 0.0;
  for (std::size_t i = 0; i < recipe.coefficients(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double c = candidate.screened->c[index];
    const double size = std::abs(c) * basis.col(index).norm();
    if (size > largest) {
      largest = size;
      name =
          recipe.nonnegative[i] && c < 0.0 ? "sign: " + coefficientName(recipe, candidate.atom->nu, i) : "";
    }
  }
  return name;
}

}  // namespace

double parameterCost(const ModelFit& fit) {
  return std::log(static_cast<double>(fit.weighting->rows()));
}

double parameters(const ModelFit& fit) {
  double count = 0.0;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    count += static_cast<double>(term.c.size() + term.nu.size());
    for (std::size_t k = 0; k < term.nu.size(); ++k) {
      if (term.recipe->nonlinear[k].spread > 0.0) {
        const Eigen::Index index = fit.offset[t] + static_cast<Eigen::Index>(term.c.size() + k);
        const double known = std::pow(fit.prior_weight[index], 2);
        const double told = fit.weighting->apply(fit.tangent.col(index)).squaredNorm();
        count -= 1.0 - std::min(1.0, std::log1p(told / known) / parameterCost(fit));
      }
    }
  }
  return count;
}

double parametersInUse(const ModelFit& fit) {
  double count = parameters(fit);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    for (std::size_t i = 0; i < term.c.size(); ++i) {
      const Eigen::Index index = fit.offset[t] + static_cast<Eigen::Index>(i);
      const double size = std::abs(term.c[i]) * fit.tangent.col(index).norm();
      count -=
          term.recipe->nonnegative[i] && size < accepted::kNextToNothing * fit.residual.norm() ? 1.0 : 0.0;
    }
  }
  return count;
}

bool unphysical(const std::string& refusal) {
  return refusal.starts_with("sign") || refusal.starts_with("range");
}

std::vector<Candidate> rank(const Atoms& atoms, const Screening& screening, double cost) {
  std::vector<Candidate> best;
  for (const Screened& screened : screening.results()) {
    const Atom& atom = atoms.items[screened.atom];
    const double score = screened.raw_gain - cost * screened.dimensions;
    if (score <= 0.0) {
      continue;
    }
    Candidate candidate{
        .atom = &atom, .screened = &screened, .score = score, .fit = {}, .refused_because = {}};
    if (screened.wrong_sign) {
      candidate.refused_because = "sign: " + coefficientName(*atom.recipe, atom.nu, 0);
    }
    const auto known = std::find_if(best.begin(), best.end(),
                                    [&](const Candidate& c) { return c.atom->recipe == atom.recipe; });
    if (known == best.end()) {
      best.push_back(std::move(candidate));
    } else if (std::pair(!screened.wrong_sign, score) >
               std::pair(!known->screened->wrong_sign, known->score)) {
      *known = std::move(candidate);
    }
  }
  // Candidates that physics refuses come last: they are shown, not fitted.
  std::sort(best.begin(), best.end(), [](const auto& a, const auto& b) {
    return std::pair(a.refused_because.empty(), a.score) > std::pair(b.refused_because.empty(), b.score);
  });
  return best;
}

void fitCandidate(ModelFitter& fitter, const ModelFit& current, double cost, Candidate& candidate) {
  std::optional<ModelFit> start = withCandidate(fitter, current, *candidate.atom, *candidate.screened);
  if (!start) {
    candidate.refused_because = "given by others";
    return;
  }
  Term& term = start->terms.back();
  term.nu = ruggedStart(fitter, current, *term.recipe, term.nu);
  candidate.fit = fitter.fit(std::move(*start), *current.weighting);
  const auto added =
      static_cast<Eigen::Index>(candidate.fit->terms.back().c.size() + candidate.fit->terms.back().nu.size());
  candidate.unit = chanceUnit(fitter.data(), *candidate.fit, added, kUnitSeed);
  candidate.gain = (current.objective - candidate.fit->objective) / candidate.unit;
  candidate.margin = candidate.gain - cost * (parameters(*candidate.fit) - parameters(current));
  const auto& edges = candidate.fit->at_edge;
  const auto edge = std::find_if(edges.begin(), edges.end(),
                                 [&](const Edge& e) { return e.label == candidate.atom->label; });
  if (edge != edges.end()) {
    candidate.refused_because = edge->reason;
  } else if (candidate.margin <= 0.0) {
    candidate.refused_because = "bic";
  }
  if (!candidate.refused_because.empty()) {
    const std::string sign = wrongSign(fitter, candidate);
    candidate.refused_because = sign.empty() ? candidate.refused_because : sign;
  }
}

Candidate* fitBest(ModelFitter& fitter, const ModelFit& current, double cost,
                   std::vector<Candidate>& candidates) {
  // Two candidates for the same data are compared under the noise of the one that leaves less.
  const auto better = [cost](const Candidate& a, const Candidate& b) {
    const double unit = a.fit->objective < b.fit->objective ? a.unit : b.unit;
    return a.fit->objective + unit * cost * parametersInUse(*a.fit) <
           b.fit->objective + unit * cost * parametersInUse(*b.fit);
  };
  Candidate* best = nullptr;
  for (std::size_t i = 0; i < std::min(kFittedCandidates, candidates.size()); ++i) {
    Candidate& candidate = candidates[i];
    if (!candidate.refused_because.empty()) {
      break;
    }
    if (best != nullptr &&
        candidate.score < accepted::kNearBest * (current.objective - best->fit->objective)) {
      break;
    }
    fitCandidate(fitter, current, cost, candidate);
    if (candidate.refused_because.empty() && (best == nullptr || better(candidate, *best))) {
      best = &candidate;
    }
  }
  return best;
}

SelectionStep describeStep(const std::vector<Candidate>& candidates, double threshold, double cost) {
  SelectionStep step;
  for (const Candidate& candidate : candidates) {
    // Candidates that physics refuses are shown with what they would have explained.
    const bool fitted = candidate.fit && !unphysical(candidate.refused_because);
    const double gain = fitted ? candidate.gain : candidate.screened->gain;
    step.ranking.push_back({.label = candidate.atom->label,
                            .gain = 0.5 * gain,
                            .threshold = 0.5 * (threshold + cost * candidate.screened->dimensions),
                            .accepted = false,
                            .refused_because = candidate.refused_because});
  }
  return step;
}

}  // namespace patella::diagnose
