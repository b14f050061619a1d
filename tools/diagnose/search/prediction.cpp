#include "tools/diagnose/search/prediction.hpp"

#include "tools/diagnose/fit/model_error.hpp"

namespace patella::diagnose {

Prediction::Prediction(const ModelFitter& fitter, const ModelFit& fit, const Dataset* heldout)
    : fitter_(fitter), heldout_(heldout) {
  if (heldout_ != nullptr) {
    const Column residual = left(fit);
    weighting_.emplace(*heldout_, residual);
    objective_ = weighting_->objective(residual);
  }
}

double Prediction::gain(const ModelFit& other) {
  if (heldout_ == nullptr) {
    return 0.0;
  }
  const auto known = gains_.find(&other);
  return known != gains_.end()
             ? known->second
             : gains_.emplace(&other, objective_ - weighting_->objective(left(other))).first->second;
}

Column Prediction::left(const ModelFit& fit) const {
  return residualOf(*heldout_, fitter_.describe(fit)).residual;
}

}  // namespace patella::diagnose
