// Whether a recording's torque was held from sample to sample, where nobody says.
#pragma once

#include <span>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// A held torque acts half a period later than its sample, on the mean. Returns the recordings with
/// TorqueTiming::kSampled, and a warning that says so, where the motion follows the torque without that half:
/// half a period too early on the mean of the joints that tell, which decides where joints contradict each
/// other, too; that gets a warning of its own. Likewise TorqueTiming::kBefore where it is a whole period.
/// Unchanged where the timing was told, or nothing speaks against a held torque. `options`: of the fit that
/// tells.
std::vector<Recording> withTorqueTiming(std::span<const Recording> recordings,
                                        const model::ModelDescription& model, const FitOptions& options);

}  // namespace patella::diagnose
