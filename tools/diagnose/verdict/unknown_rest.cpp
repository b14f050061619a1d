#include "tools/diagnose/verdict/unknown_rest.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

// The torque that the model lacks on a joint and on those where something was named, in units of what is
// left.
double missingInNoise(const Dataset& data, const MissingTorque& torque, std::span<const EffectFinding> named,
                      int joint) {
  double square = 0.0;
  for (int j = 0; j < data.joints(); ++j) {
    const bool counts =
        j == joint || std::any_of(named.begin(), named.end(),
                                  [j](const EffectFinding& effect) { return effect.joint == j; });
    if (counts) {
      square += std::pow(jointRms(data, torque.missing, j) / jointRms(data, torque.left, j), 2);
    }
  }
  return std::sqrt(square);
}

}  // namespace

bool restIsUnknown(const Dataset& data, const MissingTorque& torque, std::span<const EffectFinding> named,
                   std::span<const Dependence> dependences) {
  return std::any_of(dependences.begin(), dependences.end(), [&](const Dependence& found) {
    const double of_rest = found.explained_Nm / jointRms(data, torque.left, found.joint);
    const double share = of_rest / missingInNoise(data, torque, named, found.joint);
    return share > (of_rest > unknown::kNoNoise ? unknown::kShareOfNoNoise : unknown::kShare);
  });
}

}  // namespace patella::diagnose
