// The effects that a planned motion is to show, each in one typical shape that no motion changes: what two
// motions reveal can then be compared.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/plan/motion_limits.hpp"

namespace patella::diagnose {

struct PlannedEffect {
  std::shared_ptr<const Recipe> recipe;  ///< the plain variant of the kind
  std::vector<double> nu;                ///< the middle of its grid
};

/// Whether a motion can show the kind at all, and one number says how strong it is: not a muscle's torque,
/// which goes with EMG, nor what mechanics with several numbers makes of a drive's torque.
bool isPlannable(std::string_view kind);

/// The effects of a list such as {"coulomb_friction@2", "payload"}, without a joint on each joint where the
/// kind may act, each once; "all" names every plannable kind. Throws std::invalid_argument naming the
/// entry and what was expected.
std::vector<PlannedEffect> plannedEffects(std::span<const std::string> names,
                                          const model::ModelDescription& model, const MotionLimits& limits,
                                          double duration_s);

}  // namespace patella::diagnose
