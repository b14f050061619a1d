// Cases of the benchmark: a rig, a way, noise, what the model lacks and how strongly it shows. All follow
// from a seed, to the bit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/bench/diagnose/analysis.hpp"
#include "tools/bench/diagnose/rig.hpp"

namespace patella::bench {

enum class Suite {
  kNone,     ///< nothing is missing but the exact values of masses, centres of mass, inertias and damping
  kSingle,   ///< one effect of the library
  kDouble,   ///< two of them
  kUnknown,  ///< one effect that the library has not
  kDefect,   ///< one that breaks or wears on machines, which the library has not either
};
std::string_view suiteName(Suite suite) noexcept;

/// Empty: drawn.
struct Wish {
  std::string effect;  ///< a kind's name; for kDouble one of the two
  std::string
      mechanism;  ///< "paper_leg", "adult_leg", "light_arm", "knee", "linear_axis", "chain", "planar_chain"
  std::string motion;      ///< "multisine", "gait", "sine"
  std::size_t joints = 0;  ///< of a chain
  double strength = 0.0;   ///< of each effect; 0: drawn
};

struct CaseEffect {
  TrueEffect effect;
  /// In units of the noise below 10 Hz, when the effect is alone; see Analysis.
  double strength = 0.0;
  double raw_strength = 0.0;
  /// No motion tells it from other nominal parameters: drawn in physical sizes, `strength` is about 0. Or it
  /// is within what the declared damping is uncertain by.
  bool in_span = false;
};

struct Case {
  std::uint64_t seed = 0;
  Suite suite = Suite::kNone;
  std::string mechanism;
  std::string motion;
  Rig rig;
  std::vector<CaseEffect> effects;
  Run run;
  model::ModelDescription nominal;  ///< what a diagnosis is given
};

/// Strengths are drawn from 0.5 to 5, even in the logarithm; where a machine would not survive the effect, or
/// it is not physical, less strong ones. Throws std::invalid_argument for a wish that cannot be met.
Case drawCase(std::uint64_t seed, Suite suite, const Wish& wish = {});

struct ScaledEffect {
  CaseEffect effect;
  Run run;  ///< with the effect alone; empty where no size of it leaves the robot stable
};

/// Scales the effect until its strength in the run is `strength` within 1 %, or as near as it gets; 0 where
/// no size of it leaves the robot stable.
ScaledEffect withStrength(const Rig& rig, const TrueEffect& effect, double strength);

/// A rig with nominal parameters wrong by up to 5 to 10 %. Empty names: drawn. A chain of 0
/// joints has 2 to 7, drawn.
Rig drawRig(std::uint64_t seed, std::string& mechanism, std::string& motion, std::size_t joints = 0);
model::ModelDescription nominalModel(const Rig& rig);

}  // namespace patella::bench
