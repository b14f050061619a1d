#include "tools/diagnose/effects/recipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/effects/recipe_parts.hpp"

namespace patella::diagnose {
namespace {

Motion motionOf(const Dataset& data, const model::Mechanism& mechanism, int joint) {
  Motion motion{.joint = joint, .band_Hz = data.band_Hz()};
  double velocity = 0.0, torque = 0.0, count = 0.0;
  double low = 1e300, high = -1e300;
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      velocity += state.dq[joint] * state.dq[joint];
      torque += state.torque_Nm[joint] * state.torque_Nm[joint];
      low = std::min(low, state.q[joint]);
      high = std::max(high, state.q[joint]);
      motion.inertia += mechanism.inertia(state.q)(joint, joint);
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

std::shared_ptr<const Recipe> finished(Recipe recipe) {
  if (!recipe.basis) {
    // By value: the basis of units needs nothing but the recipe's own parameters.
    recipe.basis = [copy = recipe](Numbers nu) { return unitBasis(copy, nu); };
  }
  return std::make_shared<const Recipe>(std::move(recipe));
}

// What a leg's muscles and tissue do is looked for where there is a leg. A hand on a linear axis trembles,
// too.
bool belongsToPatient(std::string_view kind) {
  constexpr std::array kKinds{"passive_knee_moment", "spasticity"};
  return std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end();
}

// At rest only what depends on position alone can show.
bool showsAtRest(std::string_view kind) {
  constexpr std::array kKinds{"linear_stiffness", "passive_knee_moment", "torque_bias", "payload"};
  return std::find(kKinds.begin(), kKinds.end(), kind) != kKinds.end();
}

}  // namespace

std::vector<std::shared_ptr<const Recipe>> recipes(const Dataset& data, const model::Mechanism& mechanism,
                                                   std::span<const std::string> kinds,
                                                   std::span<const int> channels,
                                                   std::span<const double> smoothing_rad_s, bool leg) {
  constexpr double kAtRest = 1e-4;
  std::vector<Recipe> all;
  for (int joint = 0; joint < data.joints(); ++joint) {
    Motion motion = motionOf(data, mechanism, joint);
    motion.smoothing_rad_s = smoothing_rad_s[static_cast<std::size_t>(joint)];
    for (const std::string& kind : kinds) {
      // The knee is the last joint, whether the hip is one or not.
      if (kind == "passive_knee_moment" && joint + 1 != data.joints()) {
        continue;
      }
      if ((leg || !belongsToPatient(kind)) &&
          (data.isStatic() ? showsAtRest(kind) : motion.velocity_rms > kAtRest)) {
        addFriction(kind, motion, all);
        addMachine(kind, motion, all);
        addPatient(kind, motion, channels, all);
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

std::string_view betrayingVariable(std::string_view kind) noexcept {
  static const std::map<std::string_view, std::string_view> known{
      {"linear_stiffness", "q"},
      {"passive_knee_moment", "q"},
      {"payload", "q"},
      {"torque_ripple", "q"},
      {"encoder_offset", "q"},
      {"rotor_inertia", "ddq"},
      {"torque_gain", "tau"},
      {"actuator_lag", "tau"},
      {"actuator_delay", "tau"},
      {"load_dependent_friction", "tau"},
      {"transmission_elasticity", "tau"},
      {"backlash", "tau"},
      {"tremor", "time"},
      {"thermal_drift", "time"},
      {"torque_bias", "time"},
      {"emg_torque", "activation"},
  };
  const auto found = known.find(kind);
  return found == known.end() ? "dq" : found->second;
}

bool isOfPosition(std::string_view kind) noexcept {
  return betrayingVariable(kind) == "q" || kind == "torque_bias";
}

}  // namespace patella::diagnose
