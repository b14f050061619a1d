#include "tools/diagnose/evidence/verdict.hpp"

#include <algorithm>

#include "tools/diagnose/evidence/thresholds.hpp"

namespace patella::diagnose::evidence {

double allowedRest(const Found& found) noexcept {
  return found.effects ? kMaterialRest : threshold::kNegligibleRest;
}

Verdict verdictOf(const Found& found, std::span<const JointRest> joints) noexcept {
  const bool material = std::any_of(joints.begin(), joints.end(), [&](const JointRest& joint) {
    return joint.exceeds(allowedRest(found));
  });
  if (found.functions || found.runaway || material) {
    return Verdict::kUnknownEffect;
  }
  return found.effects ? Verdict::kEffectFound : Verdict::kNothingMissing;
}

}  // namespace patella::diagnose::evidence
