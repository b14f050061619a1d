// The whole procedure on a simulated rig that shares no dynamics with the model.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tools/bench/diagnose/cases.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::bench {

inline diagnose::Diagnosis diagnosed(const Case& drawn, std::uint64_t seed = 1) {
  const std::array recordings{drawn.run.recording};
  diagnose::DiagnoseOptions options;
  options.seed = seed;
  options.person_Nm.assign(drawn.rig.human_Nm.begin(), drawn.rig.human_Nm.begin() + drawn.nominal.joints());
  return diagnose::diagnose(recordings, {}, drawn.nominal, options);
}

inline Case multisine(std::uint64_t seed, Suite suite) {
  return drawCase(seed, suite, {.effect = {}, .mechanism = {}, .motion = "multisine"});
}

/// The kind of the one effect that a case of one is diagnosed to lack; empty where it is not one.
inline std::string onlyFinding(std::uint64_t seed) {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(seed, Suite::kSingle));
  const bool one = diagnosis.verdict == diagnose::Verdict::kEffectFound && diagnosis.effects.size() == 1;
  return one ? diagnosis.effects.front().kind : "";
}

}  // namespace patella::bench
