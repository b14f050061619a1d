// An effect of known size that is added to the torque of a measured recording.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/model/mechanism.hpp"
#include "tools/bench/diagnose/random.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::bench {

struct PlantedEffect {
  std::string kind;
  int joint = 0;
  std::vector<double> parameters;
  std::string main;          ///< parameter that says how large it is
  double size = 0.0;         ///< of that parameter
  double in_smallest = 0.0;  ///< the same in units of the smallest that would have been revealed
};

/// One of the effects that the recording as it is would have revealed, on a joint whose drive can give their
/// torque: half of them exactly as large as the smallest that it would have. Nothing where there is none.
std::optional<PlantedEffect> drawPlant(const diagnose::Diagnosis& best, const diagnose::Recording& recording,
                                       Random& random);

/// Adds what the drive would have had to give with the effect there and the motion the same.
void plantIn(diagnose::Recording& recording, const PlantedEffect& plant, const model::Mechanism& mechanism);

}  // namespace patella::bench
