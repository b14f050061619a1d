// From a diagnosis that could not tell to a plan that repairs it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/diagnose/plan/information.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// The effects that a new motion has to show, as plannedEffects() takes them:
///  - `found` ones ("coulomb_friction@2"), which a motion that is too poor leaves in doubt
///  - of those that it could not tell (Excitation::not_identifiable) the commonly missing ones, or where none
///    of them is there and nothing was found, all that a motion can show. Payloads are left out: a motion
///    tells no more of them than of the model's own masses.
///  - the commonly missing ones of a joint at rest, and of all joints where nothing else is known
std::vector<std::string> effectsToShow(const std::vector<std::string>& found,
                                       const std::vector<std::string>& not_identifiable, int joints);

/// The command line that designs a motion for a diagnosis in `out`; empty where the verdict is not
/// insufficient_excitation. The loop's configuration, which has its limits, is not known to a diagnosis:
/// CONFIG stands for it.
std::string planCommandLine(const Diagnosis& diagnosis, const std::filesystem::path& model,
                            const std::filesystem::path& out);

/// The command line that runs the motion of a plan in the folder `plan`.
std::string runCommandLine(const std::filesystem::path& config, const std::filesystem::path& plan);

/// What a plan takes from a diagnosis.json.
struct Unrevealed {
  std::vector<std::string> effects;
  std::vector<NoiseOfJoint> noise;  ///< empty where the recordings told nothing
};
/// Throws app::FileError naming the file, the key and what was expected.
Unrevealed readUnrevealed(const std::filesystem::path& diagnosis_json, int joints);

}  // namespace patella::diagnose
