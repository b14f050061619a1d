#include "tools/diagnose/search/heldout_elimination.hpp"

#include <optional>
#include <utility>

#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

std::vector<std::string> dropWhatDoesNotHold(ModelFitter& fitter, Selection& selection,
                                             const Dataset& heldout) {
  const auto error = [&](const ModelFit& fit) {
    return residualOf(heldout, fitter.describe(fit)).residual.norm();
  };
  std::vector<std::string> dropped;
  for (;;) {
    double least = held_out::kSmaller * error(selection.fit);
    std::optional<Selection> best;
    std::string label;
    for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
      if (selection.fit.terms[t].declared) {
        continue;
      }
      Selection smaller = withoutTerm(fitter, selection, t);
      const double left = error(smaller.fit);
      if (left < least && priorRelief(smaller.fit, selection.fit) < accepted::kMoved) {
        least = left;
        best = std::move(smaller);
        label = selection.fit.terms[t].recipe->label();
      }
    }
    if (!best) {
      return dropped;
    }
    dropped.push_back(label);
    selection = std::move(*best);
  }
}

}  // namespace patella::diagnose
