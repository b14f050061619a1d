#include "tests/integration/diagnose_bad/spoilt_rigs.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace patella::test {

using namespace patella::diagnose;

Recording SpoiltRig::record() const {
  Recording recording = bench::simulate(rig, effects).recording;
  recording.name = "run.csv";
  return recording;
}

SpoiltRig rubbingRig(std::string mechanism, std::uint64_t seed, double strength) {
  std::string motion = "multisine";
  SpoiltRig made{.rig = bench::drawRig(seed, mechanism, motion), .effects = {}};
  made.rig.duration_s = 20.0;
  const bench::TrueEffect rubbing{.kind = bench::Kind::kCoulomb, .joint = 0, .p = {0.2}};
  made.effects.push_back(bench::withStrength(made.rig, rubbing, strength).effect.effect);
  return made;
}

Diagnosis diagnosed(std::span<const Recording> recordings, const model::ModelDescription& model) {
  DiagnoseOptions options;
  options.effects = {"viscous_friction", "coulomb_friction", "linear_stiffness",
                     "torque_bias",      "rotor_inertia",    "actuator_lag"};
  options.bootstrap_replicates = 299;
  return diagnose::diagnose(recordings, {}, model, options);
}

bool claimsSomethingElse(const Diagnosis& diagnosis) {
  return diagnosis.verdict == Verdict::kEffectFound &&
         std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(), [](const EffectFinding& effect) {
           const auto& rivals = effect.indistinguishable_from;
           return effect.joint == 0 &&
                  (effect.kind == "coulomb_friction" ||
                   std::find(rivals.begin(), rivals.end(), "coulomb_friction") != rivals.end());
         });
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) {
    value *= factor;
  }
}

}  // namespace patella::test
