#include "tools/diagnose/search/heldout_elimination.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/search/missed.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
std::vector<std::string> dropWhatDoesNotHold(ModelFitter& fitter, Selection& selection,
                                             const Dataset& heldout) {
  const std::vector<double> unit_Nm = jointRms(fitter.data(), selection.fit.residual);
  // A hip's error is several times an ankle's, so joints count in units of theirs.
  const auto error = [&](const ModelFit& fit) {
    const std::vector<double> left_Nm = jointRms(heldout, residualOf(heldout, fitter.describe(fit)).residual);
    double squares = 0.0;
    for (std::size_t joint = 0; joint < left_Nm.size(); ++joint) {
      squares += unit_Nm[joint] > 0.0 ? std::pow(left_Nm[joint] / unit_Nm[joint], 2) : 0.0;
    }
    return std::sqrt(squares);
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
