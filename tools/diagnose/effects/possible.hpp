// Which effects a joint can have by what the mechanism is.
#pragma once

#include "core/model/model_description.hpp"
#include "tools/diagnose/effects/effect_home.hpp"

namespace patella::diagnose {

/// A person's muscles and tissue act where a joint turns. A knee is a joint that flexes in the plane of the
/// hip: on a leg the second, on a chain any whose axis is parallel to that of the joint before, and a joint
/// alone. A payload hangs where a segment has a direction.
bool mayHave(const EffectHome& home, const model::MechanismDescription& mechanism, int joint);

}  // namespace patella::diagnose
