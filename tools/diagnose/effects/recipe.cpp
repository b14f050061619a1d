#include "tools/diagnose/effects/recipe.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/possible.hpp"
#include "tools/diagnose/effects/recipe_parts.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"

namespace patella::diagnose {
namespace {

Motion motionOf(const Dataset& data, const model::Mechanism& mechanism, int joint) {
  Motion motion{.joint = joint, .band_Hz = data.band_Hz()};
  double velocity = 0.0, torque = 0.0, count = 0.0;
  double low = 1e300, high = -1e300;
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      velocity += state.dq[joint] * state.dq[joint];
      low = std::min(low, state.q[joint]);
      high = std::max(high, state.q[joint]);
      motion.inertia += mechanism.inertia(state.q)(joint, joint);
    }
    for (const JointVector& torque_Nm : series.measured_torque_Nm) {
      torque += torque_Nm[joint] * torque_Nm[joint];
    }
    count += static_cast<double>(series.states.size());
  }
  motion.duration_s = data.isStatic() ? 0.0 : data.time_s().maxCoeff() - data.time_s().minCoeff();
  motion.velocity_rms = std::sqrt(velocity / count);
  motion.torque_rms = std::sqrt(torque / count);
  motion.lowest_position = low;
  motion.position_range = high - low;
  motion.inertia /= count;
  return motion;
}

// Most effects: the torque of one coefficient alone is the basis. It is taken at a strength that is within
// the range of every effect, and scaled.
std::vector<std::vector<BasisTerm>> unitBasis(const Recipe& recipe, Numbers nu) {
  constexpr double kProbe = 0.1;
  std::vector<std::vector<BasisTerm>> bases;
  if (recipe.coefficients() == 0) {
    return {{{.weight = 1.0, .parameters = recipe.parameters({}, nu)}}};
  }
  for (std::size_t i = 0; i < recipe.coefficients(); ++i) {
    std::vector<double> probe(recipe.coefficients(), 0.0);
    probe[i] = kProbe;
    bases.push_back({{.weight = 1.0 / kProbe, .parameters = recipe.parameters(probe, nu)}});
  }
  return bases;
}

// Acts on what the drive gives: on a joint whose drive is off it has nothing to act on.
bool needsDrive(const EffectHome& home) {
  return home.shows == Shows::kTorque || home.shows == Shows::kTorqueRate;
}

}  // namespace

std::shared_ptr<const Recipe> finished(Recipe recipe) {
  if (!recipe.basis) {
    // By value: the basis of units needs nothing but the recipe's own parameters.
    recipe.basis = [copy = recipe](Numbers nu) { return unitBasis(copy, nu); };
  }
  return std::make_shared<const Recipe>(std::move(recipe));
}

std::vector<std::shared_ptr<const Recipe>> recipes(const Dataset& data,
                                                   const model::MechanismDescription& description,
                                                   std::span<const std::string> kinds,
                                                   std::span<const int> channels,
                                                   std::span<const double> smoothing_rad_s) {
  constexpr double kAtRest = 1e-4;
  const model::DynamicsModel bare = model::makeModel({.mechanism = description, .effects = {}});
  const model::Mechanism& mechanism = bare.mechanism();
  const std::vector<bool> driven = drivenJoints(data, mechanism);
  std::vector<Recipe> all;
  for (int joint = 0; joint < data.joints(); ++joint) {
    Motion motion = motionOf(data, mechanism, joint);
    motion.smoothing_rad_s = smoothing_rad_s[static_cast<std::size_t>(joint)];
    for (const std::string& kind : kinds) {
      const EffectHome& home = effectHome(kind);
      const bool shown = data.isStatic() ? home.at_rest : motion.velocity_rms > kAtRest;
      const bool acts = driven[static_cast<std::size_t>(joint)] || !needsDrive(home);
      if (shown && acts && mayHave(home, description, joint)) {
        home.add(motion, channels, all);
      }
    }
  }
  std::vector<std::shared_ptr<const Recipe>> shared;
  for (Recipe& recipe : all) {
    shared.push_back(finished(std::move(recipe)));
  }
  return shared;
}

std::shared_ptr<const Recipe> dryFriction(int joint, double smoothing_rad_s) {
  Recipe recipe = single("coulomb_friction", {.joint = joint}, "level_Nm", true, smoothing_rad_s);
  recipe.variant = fmt::format("turning round at {} rad/s", smoothing_rad_s);
  return finished(std::move(recipe));
}

std::string_view betrayingVariable(std::string_view kind) {
  switch (effectHome(kind).shows) {
    case Shows::kPosition:
      return "q";
    case Shows::kVelocity:
      return "dq";
    case Shows::kAcceleration:
      return "ddq";
    case Shows::kTorque:
    case Shows::kTorqueRate:
      return "tau";
    case Shows::kTime:
      return "time";
    case Shows::kActivation:
      return "activation";
  }
  return "";
}

bool isOfPosition(std::string_view kind) {
  return betrayingVariable(kind) == "q" || kind == "torque_bias";
}

}  // namespace patella::diagnose
