// The error before and after, and what it says against the answer.
#pragma once

#include <optional>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

struct BeforeAndAfter {
  const Dataset& train;
  const std::optional<Dataset>& heldout;
  const model::ModelDescription& given;
  model::ModelDescription refitted;  ///< the given model with its nominal parameters fitted
  model::ModelDescription extended;
  Column unexplained;  ///< what the extended model leaves of the training data's whole torque
};

/// Writes errors, noise floor, curves and the extended model into the result. What makes the error of
/// held-out data larger is taken back; that, and a held-out part with an error out of proportion, are
/// doubts.
void judgeByErrors(const BeforeAndAfter& models, Diagnosis& result);

/// The same where nothing was fitted.
void leaveAsItWas(const Dataset& train, const std::optional<Dataset>& heldout,
                  const model::ModelDescription& given, Diagnosis& result);

}  // namespace patella::diagnose
