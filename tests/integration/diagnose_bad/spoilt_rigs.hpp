// Short runs on the benchmark's rigs, for tests to spoil, and the diagnosis of what they have become.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/diagnose/cases.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::test {

struct SpoiltRig {
  bench::Rig rig;
  std::vector<bench::TrueEffect> effects;

  diagnose::Recording record() const;
  model::ModelDescription model() const { return bench::nominalModel(rig); }
};

/// A rig of 20 s on sums of sinusoids whose first joint has dry friction of this many times the noise.
SpoiltRig rubbingRig(std::string mechanism, std::uint64_t seed, double strength = 3.0);

diagnose::Diagnosis diagnosed(std::span<const diagnose::Recording> recordings,
                              const model::ModelDescription& model);

/// True where the diagnosis claims to have found an effect, and none of what it offers is dry friction on
/// joint 1.
bool claimsSomethingElse(const diagnose::Diagnosis& diagnosis);

void scale(std::vector<double>& values, double factor);

}  // namespace patella::test
