#include "tools/diagnose/verdict/unknown_rest.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/regression/elementary.hpp"

namespace patella::diagnose {
namespace {

/// Share of the torque that the model lacks that a smooth function must find behind the named effects
/// for all to be called unknown. Below, it may as well be that nature's effect is not quite the library's, or
/// that a person's push goes with the motion.
constexpr double kUnknownShare = 0.2;
/// Less suffices where the function finds a third of what is left behind the named effects: such a rest is no
/// noise. On measured data, whose friction is not quite the library's, it stays below 2 % of the missing
/// torque.
constexpr double kUnknownShareOfNoNoise = 0.05;
constexpr double kNoNoise = 1.0 / 3.0;

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
    return share > (of_rest > kNoNoise ? kUnknownShareOfNoNoise : kUnknownShare);
  });
}

}  // namespace patella::diagnose
