// The home of each effect: all that a diagnosis knows of a kind beside its equation, parameters and ranges,
// which stand in core/model/effects.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "tools/diagnose/effects/recipe.hpp"

namespace patella::diagnose {

struct Motion;

/// Variable on which an effect shows: its torque is a curve over it.
enum class Shows { kPosition, kVelocity, kAcceleration, kTorque, kTorqueRate, kTime, kActivation };

struct EffectHome {
  std::string_view kind;
  std::string_view what;  ///< what it is on a machine, in one sentence
  Shows shows = Shows::kVelocity;
  /// Parameters in proportion to which the torque grows. Those of one group grow together.
  std::vector<std::vector<std::string_view>> strengths{};
  std::vector<std::string_view> log_strengths{};  ///< logarithms of what the torque grows in proportion to
  /// Parameter that tells it from plainer effects of the same variable: where it stands at an end of the
  /// search, the effect is another one.
  std::string_view distinguished_by{};
  /// Its strength and its time constant make up for each other in a short recording: how well its torque is
  /// known says whether it is there.
  bool told_by_torque = false;
  bool at_rest = false;        ///< postures at rest show it, too
  bool of_patient = false;     ///< of a person's muscles and tissue, which no sliding joint has
  bool of_knee = false;        ///< looked for on knees only; where there may be one: possible.hpp
  bool along_segment = false;  ///< has a place along the joint's segment, which has to have a direction
  /// Appends the recipes, by which a fit looks for it; none where the motion could not show it. `channels`:
  /// EMG channels that were recorded, from 1.
  std::function<void(const Motion& motion, std::span<const int> channels, std::vector<Recipe>& all)> add;
};

/// One for every kind in the catalogue of effects, in no order.
std::span<const EffectHome> effectHomes();

/// Throws std::logic_error, naming the kind, where it has none.
const EffectHome& effectHome(std::string_view kind);

}  // namespace patella::diagnose
