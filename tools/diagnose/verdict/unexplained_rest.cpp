#include "tools/diagnose/verdict/unexplained_rest.hpp"

#include <utility>

#include "tools/diagnose/search/exchange.hpp"
#include "tools/diagnose/search/outweighed.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/dependence.hpp"

namespace patella::diagnose {

std::vector<double> leastUnnamed_Nm(const ModelFitter& fitter) {
  std::vector<double> least_Nm = fitter.leastTorque_Nm();
  for (double& torque_Nm : least_Nm) {
    torque_Nm *= unknown::kLeastOfLoad / accepted::kLeastOfLoad;
  }
  return least_Nm;
}

UnexplainedRest unexplainedRest(const AnalysedRecordings& recordings, const model::Mechanism& mechanism,
                                std::span<const double> noise_Nm, const DiagnoseOptions& options,
                                MissingEffects& found) {
  const double level = (found.namesAny() ? unknown::kLevelBehindNamed : 1.0) * accepted::kFamilyWiseP;
  // Behind what was named, a dependence is held against its size.
  const std::vector<double> least_Nm =
      found.namesAny() ? found.fitter->leastTorque_Nm() : leastUnnamed_Nm(*found.fitter);
  const auto left = [&](const ModelFit& fit) {
    UnexplainedRest rest{.whole = found.fitter->onWholeTorque(fit), .joints = {}, .dependences = {}};
    rest.joints = jointRests(recordings.train, mechanism, rest.whole.residual, noise_Nm);
    rest.dependences = testDependence(recordings.train, rest.whole, recordings.channels, least_Nm,
                                      4 * options.bootstrap_replicates, level, options.seed + 104729);
    return rest;
  };
  UnexplainedRest rest = left(found.selection.fit);
  if (rest.dependences.empty()) {
    return rest;
  }
  for (Selection& other : withRivals(*found.fitter, found.atoms, found.selection)) {
    UnexplainedRest of_other = left(other.fit);
    if (of_other.dependences.empty()) {
      found.selection = std::move(other);
      if (options.gates.rest) {
        found.outweighed = outweighedByRest(*found.fitter, found.selection, noise_Nm);
      }
      return of_other;
    }
  }
  return rest;
}

}  // namespace patella::diagnose
