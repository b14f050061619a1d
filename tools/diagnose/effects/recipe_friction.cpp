#include <algorithm>

#include "tools/diagnose/effects/recipe_parts.hpp"

namespace patella::diagnose {
namespace {

Recipe asymmetricFriction(const Motion& motion, double smoothing, bool viscous) {
  Recipe recipe = start("asymmetric_friction", motion, std::vector<bool>(viscous ? 4 : 2, true));
  recipe.variant = viscous ? "levels and viscous" : "levels";
  // A bias only moves one level up and the other down.
  recipe.contains = {"coulomb_friction", "torque_bias", "asymmetric_friction"};
  if (viscous) {
    recipe.contains.emplace_back("viscous_friction");
  }
  recipe.parameters = [=](Numbers c, Numbers) -> std::vector<double> {
    return Parameters("asymmetric_friction")
        .set("level_positive_Nm", c[0])
        .set("level_negative_Nm", c[1])
        .set("viscous_positive_Nms_rad", viscous ? c[2] : 0.0)
        .set("viscous_negative_Nms_rad", viscous ? c[3] : 0.0)
        .set(kSmoothing, smoothing);
  };
  return recipe;
}

// Friction of a lubricated contact grows with speed before it is fully there: what a film of grease carries
// of it is shear. Beside friction that is there at once, this is the part that is not. Nonlinear: the
// velocity.
Recipe gradualFriction(const Motion& motion, double smoothing) {
  Recipe recipe = start("coulomb_friction", motion, {true});
  recipe.variant = "gradual";
  const double rms = motion.velocity_rms;
  recipe.nonlinear = {{.lower = std::max(5.0 * smoothing, 0.02 * rms), .upper = 0.5 * rms}};
  recipe.grid = product({{0.05 * rms, 0.12 * rms, 0.3 * rms}});
  recipe.parameters = [](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("coulomb_friction").set("level_Nm", c[0]).set(kSmoothing, nu[0]);
  };
  return recipe;
}

Recipe stribeckFriction(const Motion& motion, double smoothing) {
  Recipe recipe = start("stribeck_friction", motion, {true, true});
  recipe.contains = {"stribeck_friction", "coulomb_friction"};
  const double rms = motion.velocity_rms;
  // Narrower than that, a peak at rest is how the measured velocity turns round and not how the joint rubs.
  recipe.nonlinear = {{.lower = 0.02 * rms, .upper = 1.0 * rms, .closed_below = true}};
  recipe.grid = product({{0.03 * rms, 0.06 * rms, 0.15 * rms, 0.35 * rms}});
  recipe.parameters = [=](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("stribeck_friction")
        .set("level_Nm", c[0])
        .set("stribeck_level_Nm", c[1])
        .set("stribeck_velocity_rad_s", nu[0])
        .set(kSmoothing, smoothing);
  };
  return recipe;
}

// Nonlinear: the deflection at which the full level would be reached, which keeps the torque linear in the
// level.
Recipe preslidingHysteresis(const Motion& motion) {
  Recipe recipe = start("presliding_hysteresis", motion, {true});
  recipe.contains = {"presliding_hysteresis", "coulomb_friction"};
  const double range = motion.position_range;
  recipe.nonlinear = {{.lower = 0.0001 * range, .upper = 0.1 * range}};
  recipe.grid = product({{0.001 * range, 0.005 * range, 0.02 * range, 0.06 * range}});
  recipe.parameters = [](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("presliding_hysteresis").set("level_Nm", c[0]).set("stiffness_Nm_rad", c[0] / nu[0]);
  };
  return recipe;
}

}  // namespace

std::vector<EffectHome> frictionEffects() {
  return {
      {.kind = "viscous_friction",
       .what = "Drag in proportion to speed: oil, grease, eddy currents.",
       .shows = Shows::kVelocity,
       .strengths = {{"coefficient_Nms_rad"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(single("viscous_friction", motion, "coefficient_Nms_rad", true));
           }},
      {.kind = "coulomb_friction",
       .what = "Dry friction of one level in both directions.",
       .shows = Shows::kVelocity,
       .strengths = {{"level_Nm"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(single("coulomb_friction", motion, "level_Nm", true, motion.smoothing_rad_s));
             if (Recipe gradual = gradualFriction(motion, motion.smoothing_rad_s);
                 gradual.nonlinear[0].lower < gradual.grid.back()[0]) {
               std::erase_if(gradual.grid, [&](const std::vector<double>& nu) {
                 return nu[0] <= gradual.nonlinear[0].lower;
               });
               all.push_back(std::move(gradual));
             }
           }},
      {.kind = "asymmetric_friction",
       .what = "Dry and viscous friction that differ between the directions.",
       .shows = Shows::kVelocity,
       .strengths = {{"level_positive_Nm"},
                     {"level_negative_Nm"},
                     {"viscous_positive_Nms_rad"},
                     {"viscous_negative_Nms_rad"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(asymmetricFriction(motion, motion.smoothing_rad_s, false));
             all.push_back(asymmetricFriction(motion, motion.smoothing_rad_s, true));
           }},
      {.kind = "stribeck_friction",
       .what = "Dry friction with a peak at rest, which falls with speed.",
       .shows = Shows::kVelocity,
       .strengths = {{"level_Nm"}, {"stribeck_level_Nm"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(stribeckFriction(motion, motion.smoothing_rad_s));
           }},
      {.kind = "load_dependent_friction",
       .what = "Friction in proportion to the torque that a gear transmits.",
       .shows = Shows::kTorque,
       .strengths = {{"coefficient"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(
                 single("load_dependent_friction", motion, "coefficient", true, motion.smoothing_rad_s));
           }},
      {.kind = "presliding_hysteresis",
       .what = "A contact that yields like a spring before it slides.",
       .shows = Shows::kVelocity,
       .strengths = {{"level_Nm", "stiffness_Nm_rad"}},
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(preslidingHysteresis(motion)); }},
  };
}

}  // namespace patella::diagnose
