#include "tools/diagnose/evidence/verdict.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/evidence/thresholds.hpp"

namespace patella::diagnose::evidence {

double JointRest::structure_Nm() const noexcept {
  return std::sqrt(std::max(left_Nm * left_Nm - noise_Nm * noise_Nm, 0.0));
}

bool JointRest::isMaterial(bool beside_effects) const noexcept {
  return structure_Nm() >
         (beside_effects ? threshold::kMaterialRest : threshold::kNegligibleRest) * torque_Nm;
}

Verdict verdictOf(const Found& found, std::span<const JointRest> joints) noexcept {
  const bool material = std::any_of(joints.begin(), joints.end(),
                                    [&](const JointRest& joint) { return joint.isMaterial(found.effects); });
  if (found.functions || found.runaway || material) {
    return Verdict::kUnknownEffect;
  }
  return found.effects ? Verdict::kEffectFound : Verdict::kNothingMissing;
}

}  // namespace patella::diagnose::evidence
