// How well fits predict what was not fitted: evidence between effects that could stand for each other.
#pragma once

#include <map>
#include <optional>

#include "tools/diagnose/fit/model_fit.hpp"

namespace patella::diagnose {

class Prediction {
 public:
  /// Compares with `fit`, under the noise that it leaves of `heldout`. Without held-out data nothing is told.
  /// All must outlive it.
  Prediction(const ModelFitter& fitter, const ModelFit& fit, const Dataset* heldout);

  /// Fall of −2 log likelihood of the held-out data with another fit in its place. A fit is looked at once,
  /// and must stay where it is.
  double gain(const ModelFit& other);

 private:
  Column left(const ModelFit& fit) const;

  const ModelFitter& fitter_;
  const Dataset* heldout_;
  std::optional<Weighting> weighting_;
  double objective_ = 0.0;
  std::map<const ModelFit*, double> gains_;
};

}  // namespace patella::diagnose
