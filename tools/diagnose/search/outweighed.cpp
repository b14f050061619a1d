#include "tools/diagnose/search/outweighed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/search/free_function.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

struct Joints {
  std::vector<double> square_Nm2;  ///< of what is left, joint by joint
};

Joints leftBy(ModelFitter& fitter, const ModelFit& fit) {
  const Column residual = fitter.onWholeTorque(fit).residual;
  Joints joints;
  for (int joint = 0; joint < fitter.data().joints(); ++joint) {
    joints.square_Nm2.push_back(std::pow(jointRms(fitter.data(), residual, joint), 2));
  }
  return joints;
}

// A declared effect that comes back in a term's place stretches as far as the data ask. What it cannot
// explain within its tolerance is what the term does.
ModelFit withinTolerance(ModelFit fit, const std::vector<Term>& came_back, double tolerance) {
  const double most = runaway::kWithinTolerance * tolerance;
  for (Term& term : fit.terms) {
    if (std::any_of(came_back.begin(), came_back.end(),
                    [&](const Term& back) { return term.declared && back.recipe == term.recipe; })) {
      for (std::size_t i = 0; i < term.c.size(); ++i) {
        term.c[i] = std::clamp(term.c[i], term.prior_c[i] - most, term.prior_c[i] + most);
      }
    }
  }
  return fit;
}

double mostOverRest(const Joints& with, const Joints& without, std::span<const double> noise_Nm) {
  double most = 0.0;
  for (std::size_t joint = 0; joint < with.square_Nm2.size(); ++joint) {
    const double own = without.square_Nm2[joint] - with.square_Nm2[joint];
    const double rest = with.square_Nm2[joint] - noise_Nm[joint] * noise_Nm[joint];
    if (own > 0.0) {
      most = std::max(most, rest > 0.0 ? std::sqrt(own / rest) : std::numeric_limits<double>::infinity());
    }
  }
  return most;
}

// The terms of one joint, the least one first: what it explained is left from then on. What may not be named
// on other joints is left where it is, as something explains it.
std::vector<const Recipe*> outweighedOn(int joint, ModelFitter& fitter, Selection selection,
                                        std::span<const double> noise_Nm) {
  std::vector<const Recipe*> outweighed;
  for (;;) {
    const Joints with = leftBy(fitter, selection.fit);
    const std::vector<FreeFunction> functions = freeFunctions(fitter.data(), selection);
    double least = asserted::kOverRest;
    std::optional<Selection> best;
    const Recipe* recipe = nullptr;
    for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
      const Term& term = selection.fit.terms[t];
      if (term.recipe->joint != joint || term.declared || isPartOf(functions, t)) {
        continue;
      }
      Selection smaller = withoutTerm(fitter, selection, t);
      const ModelFit without = withinTolerance(smaller.fit, term.replaced, runaway::kTolerance);
      const double over = mostOverRest(with, leftBy(fitter, without), noise_Nm);
      if (over < least) {
        least = over;
        best = std::move(smaller);
        recipe = term.recipe.get();
      }
    }
    if (!best) {
      return outweighed;
    }
    outweighed.push_back(recipe);
    selection = std::move(*best);
  }
}

}  // namespace

double overRest(ModelFitter& fitter, const ModelFit& with, const ModelFit& without,
                std::span<const double> noise_Nm) {
  return mostOverRest(leftBy(fitter, with), leftBy(fitter, without), noise_Nm);
}

std::vector<const Recipe*> outweighedByRest(ModelFitter& fitter, const Selection& selection,
                                            std::span<const double> noise_Nm) {
  std::vector<const Recipe*> outweighed;
  for (int joint = 0; joint < fitter.data().joints(); ++joint) {
    for (const Recipe* recipe : outweighedOn(joint, fitter, selection, noise_Nm)) {
      outweighed.push_back(recipe);
    }
  }
  return outweighed;
}

}  // namespace patella::diagnose
