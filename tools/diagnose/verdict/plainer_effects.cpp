#include "tools/diagnose/verdict/plainer_effects.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/outweighed.hpp"
#include "tools/diagnose/search/restatement.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/findings.hpp"
#include "tools/diagnose/verdict/runaways.hpp"

namespace patella::diagnose {
namespace {

class Plainer {
 public:
  Plainer(const model::Mechanism& mechanism, std::span<const double> noise_Nm, const DiagnoseOptions& options,
          MissingEffects& found)
      : mechanism_(mechanism), noise_Nm_(noise_Nm), options_(options), found_(found) {}

  // False where nothing plainer would do.
  bool restateOne() {
    const Selection& selection = found_.selection;
    std::vector<std::size_t> wider;
    for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
      const Term& term = selection.fit.terms[t];
      if (!term.declared && !term.recipe->contains.empty()) {
        wider.push_back(t);
      }
    }
    if (wider.empty()) {
      return false;
    }
    const std::size_t unknown = unknownIn(selection);
    for (const std::size_t term : wider) {
      std::optional<Selection> plainer = withPlainer(*found_.fitter, found_.atoms, selection, term);
      if (plainer && restSpeaksFor(plainer->fit, withoutTerm(*found_.fitter, selection, term).fit) &&
          unknownIn(*plainer) <= unknown) {
        found_.selection = std::move(*plainer);
        return true;
      }
    }
    return false;
  }

 private:
  // Found terms of unknown strength.
  std::size_t unknownIn(const Selection& selection) const {
    const ModelFit& fit = selection.fit;
    const Dataset& data = found_.fitter->data();
    const std::vector<JointRest> rests =
        jointRests(data, mechanism_, found_.fitter->onWholeTorque(fit).residual, noise_Nm_);
    const Eigen::MatrixXd covariance =
        withRest(widerCovariance(data, fit, options_.bootstrap_replicates, options_.covarianceSeed()), data,
                 fit, rests);
    std::size_t unknown = 0;
    for (std::size_t t = 0; t < fit.terms.size(); ++t) {
      if (!fit.terms[t].declared &&
          strengthIsUnknown(findingOf(fit, covariance, t, selection.evidence[t], data.joints()))) {
        ++unknown;
      }
    }
    return unknown;
  }

  bool restSpeaksFor(const ModelFit& plainer, const ModelFit& without) const {
    return overRest(*found_.fitter, found_.selection.fit, plainer, noise_Nm_) <
               kDeviations95 / std::sqrt(asserted::kLooks) &&
           overRest(*found_.fitter, plainer, without, noise_Nm_) >= asserted::kOverRest;
  }

  const model::Mechanism& mechanism_;
  std::span<const double> noise_Nm_;
  const DiagnoseOptions& options_;
  MissingEffects& found_;
};

}  // namespace

void preferPlainer(const model::Mechanism& mechanism, std::span<const double> noise_Nm,
                   const DiagnoseOptions& options, MissingEffects& found) {
  Plainer plainer(mechanism, noise_Nm, options, found);
  bool restated = false;
  while (plainer.restateOne()) {
    restated = true;
  }
  if (restated) {
    found.outweighed = outweighedByRest(*found.fitter, found.selection, noise_Nm);
  }
}

}  // namespace patella::diagnose
