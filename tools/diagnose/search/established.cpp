#include "tools/diagnose/search/established.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/free_function.hpp"
#include "tools/diagnose/search/gates.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

bool isUnknown(const ParameterEstimate& estimate) {
  const double half = estimate.by_factor ? std::log(estimate.ci95[1] / estimate.value)
                                         : (estimate.ci95[1] - estimate.value) / std::abs(estimate.value);
  return half > held_out::kUnknown;
}

bool holdsZero(const ParameterEstimate& estimate) {
  return estimate.ci95[0] <= 0.0 && estimate.ci95[1] >= 0.0;
}

std::optional<std::size_t> notEstablished(const Dataset& data, const Selection& selection,
                                          const Eigen::MatrixXd& covariance) {
  const ModelFit& fit = selection.fit;
  const std::vector<FreeFunction> functions = freeFunctions(data, selection);
  const auto found =
      std::count_if(fit.terms.begin(), fit.terms.end(), [](const Term& term) { return !term.declared; });
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    if (term.declared || isPartOf(functions, t)) {
      continue;
    }
    std::vector<ParameterEstimate> all = estimates(fit, covariance, t);
    // Other parameters of the kind, which this variant leaves at nothing.
    std::erase_if(all, [](const ParameterEstimate& e) { return e.ci95[0] == e.ci95[1]; });
    const bool one_number = term.c.size() + term.nu.size() == 1;
    if ((one_number && found > 1 && std::any_of(all.begin(), all.end(), holdsZero)) ||
        (!all.empty() && std::all_of(all.begin(), all.end(), isUnknown))) {
      return t;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> dropWhatIsNotEstablished(ModelFitter& fitter, Selection& selection, int replicates,
                                                  std::uint64_t seed) {
  std::vector<std::string> dropped;
  while (const auto term = notEstablished(fitter.data(), selection,
                                          widerCovariance(fitter.data(), selection.fit, replicates, seed))) {
    dropped.push_back(selection.fit.terms[*term].recipe->label());
    selection = withoutTerm(fitter, selection, *term);
  }
  return dropped;
}

}  // namespace patella::diagnose
