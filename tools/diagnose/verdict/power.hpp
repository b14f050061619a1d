// Power of a recording: the smallest size of every effect that it would have revealed.
#pragma once

#include <cmath>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/verdict/detector.hpp"

namespace patella::diagnose {

/// Smallest rms torque, N·m, of a shape that four in five recordings like this one would have revealed: above
/// what chance brings, and above asserted::kOverRest times `structure_Nm`, what nothing explains on its
/// joint, of which asserted::kLooks looks are known. Infinite where nothing tells it from the given
/// parameters. `noise_Nm`: rms of what the fit leaves there.
double smallestTorque_Nm(const Detectable& shape, double threshold, double noise_Nm, double structure_Nm);

/// The main parameter of an effect of some size, and with it all of its parameters.
struct Strength {
  double main =
      std::nan("");  ///< NaN where the torque does not grow with one number; infinite beyond its range
  std::vector<double> parameters{};
};
/// What it takes for the effect's torque to be `factor` times that of its first basis at ν.
Strength strengthAt(const Recipe& recipe, const std::vector<double>& nu, double factor);

/// Name of the parameter by which a kind is sized, with its unit.
std::string mainParameter(std::string_view kind);

/// What chance brings the last step of a search.
struct Chance {
  double threshold = 0.0;  ///< fall of −2 log-likelihood
  double margin = 0.0;     ///< the same less the cost of the parameters
};
Chance chanceOf(const Diagnosis& diagnosis, const ModelFit& fit);

/// One for every effect that was looked for, but for `known` ones ("coulomb_friction@1") that were found or
/// are declared, and for those that declared ones give, whose change would tell them: the median over typical
/// shapes of the kind's plain variant, the ones a torque changes most first.
std::vector<Revealed> revealedBy(ModelFitter& fitter, const ModelFit& fit, const Atoms& atoms,
                                 std::span<const RestOfJoint> rests, const std::set<std::string>& known,
                                 const Chance& chance);

/// "0.05 N·m", "2 kg at 0.3 m", "1.2 N·m rms" where the torque does not grow with one number, or "never".
std::string sizeWords(const Revealed& revealed, const Units& units);

/// The plain effects whose smallest torque is largest against their joint's; empty where nothing is known.
struct RevealedWords {
  std::string shown;   ///< "coulomb friction on joint 1 from 0.05 N·m, …"
  std::string hidden;  ///< "payload on joint 2, …": would not show at any size
};
RevealedWords revealedWords(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
