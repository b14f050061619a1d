#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tools/diagnose/effects/recipe_parts.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

// c = (stiffness, stiffness times rest position). A constant torque is no spring that rests far away.
Recipe linearStiffness(const Motion& motion) {
  Recipe recipe = start("linear_stiffness", motion, {true, false});
  recipe.contains = {"linear_stiffness", "torque_bias"};
  recipe.parameters = [](Numbers c, Numbers) -> std::vector<double> {
    return Parameters("linear_stiffness")
        .set("stiffness_Nm_rad", c[0])
        .set("rest_position_rad", c[0] > 0.0 ? c[1] / c[0] : 0.0);
  };
  constexpr double kFarthestRest = 2.0;  // ranges of the motion, from its middle
  const double middle = motion.lowest_position + 0.5 * motion.position_range;
  const double farthest = kFarthestRest * motion.position_range;
  recipe.beyond = [=](Numbers c, Numbers) -> std::string {
    return std::abs(c[1] - c[0] * middle) > c[0] * farthest ? "rest_position_rad" : "";
  };
  recipe.basis = [](Numbers) -> std::vector<std::vector<BasisTerm>> {
    const std::vector<double> centred =
        Parameters("linear_stiffness").set("stiffness_Nm_rad", 1.0).set("rest_position_rad", 0.0);
    const std::vector<double> shifted =
        Parameters("linear_stiffness").set("stiffness_Nm_rad", 1.0).set("rest_position_rad", 1.0);
    return {{{.weight = 1.0, .parameters = centred}},
            {{.weight = 1.0, .parameters = shifted}, {.weight = -1.0, .parameters = centred}}};
  };
  return recipe;
}

// Above the band's edge little is left of a line, but what is left is as much a line.
double fastestTremor_Hz(const Motion& motion) {
  constexpr double kBeyondEdge = 1.25;
  return std::min(tremor::kHighest_Hz, kBeyondEdge * motion.band_Hz);
}

/// The phase of no tremor holds for so long; of a longer recording a line is found by its power alone
/// (tremor_line.hpp).
constexpr double kLongestInPhase_s = 60.0;

Recipe tremorRecipe(const Motion& motion) {
  // Finer than the width of a line of this length, which would fall between two points.
  const double step_Hz = 0.6 / std::min(motion.duration_s, kLongestInPhase_s);
  return oscillation("tremor", motion, "frequency_Hz",
                     range(tremor::kLowest_Hz, fastestTremor_Hz(motion), step_Hz));
}

Recipe spasticity(const Motion& motion, double direction) {
  Recipe recipe = start("spasticity", motion, {true});
  recipe.variant = direction > 0.0 ? "direction +1" : "direction -1";
  const double rms = motion.velocity_rms;
  // Nerves to the spinal cord and back take 20 ms, from which clocks may take something: what answers at once
  // is no reflex.
  recipe.nonlinear = {{.lower = 0.1 * rms, .upper = 2.0 * rms}, {.lower = 0.01, .upper = 0.1}};
  recipe.grid = product({{0.3 * rms, 0.8 * rms, 1.3 * rms}, {0.02, 0.05, 0.08}});
  recipe.parameters = [=](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("spasticity")
        .set("gain_Nms_rad", c[0])
        .set("threshold_rad_s", nu[0])
        .set("delay_s", nu[1])
        .set("direction", direction);
  };
  return recipe;
}

Recipe emgTorque(const Motion& motion, int channel) {
  Recipe recipe = start("emg_torque", motion, {false});
  recipe.variant = fmt::format("channel {}", channel);
  recipe.nonlinear = {{.lower = 0.0, .upper = 0.15}};
  recipe.grid = product({{0.02, 0.05, 0.08, 0.11}});
  recipe.parameters = [=](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("emg_torque").set("gain_Nm", c[0]).set("channel", channel).set("delay_s", nu[0]);
  };
  return recipe;
}

// c = (factor of the flexion term, factor of the extension term, offset); the slopes are nonlinear.
Recipe passiveKneeMoment(const Motion& motion) {
  Recipe recipe = start("passive_knee_moment", motion, {true, true, false});
  recipe.contains = {"passive_knee_moment", "torque_bias"};
  const Parameters typical("passive_knee_moment");
  const double silent = typical.of("flexion_log_Nm").minimum;
  constexpr std::array kSlopes{"flexion_knee_1_rad", "flexion_hip_1_rad", "extension_knee_1_rad",
                               "extension_hip_1_rad"};
  // Logarithms of the ratios to the published slopes, which are means over ten persons. Two persons differ by
  // a factor of two easily; quite free, the exponentials would fit anything. Motion bends by other things
  // than tissue, so that there the slopes have to stay near what is known.
  const bool at_rest = motion.duration_s == 0.0;
  const double spread = std::log(at_rest ? 2.0 : 1.5);
  const double most = (at_rest ? 3.0 : 1.5) * spread;
  // For the same reason the branch against flexion, by far the smaller one, may not be so many times what the
  // other lets expect: a spring that hardens, or a contact, would look like it.
  constexpr double kMostOneSided = 10.0;
  recipe.nonlinear.assign(kSlopes.size(), {.lower = -most, .upper = most, .spread = spread});
  recipe.grid = product(std::vector<std::vector<double>>(kSlopes.size(), {0.0}));
  const auto shape = [=](Numbers nu, double flexion, double extension, double offset) {
    Parameters parameters("passive_knee_moment");
    for (std::size_t i = 0; i < kSlopes.size(); ++i) {
      parameters.set(kSlopes[i], typical.of(kSlopes[i]).initial * std::exp(nu[i]));
    }
    parameters.set("flexion_log_Nm", flexion > 0.0 ? std::log(flexion) : silent);
    parameters.set("extension_log_Nm", extension > 0.0 ? std::log(extension) : silent);
    parameters.set("offset_Nm", offset);
    return std::vector<double>(parameters);
  };
  recipe.parameters = [=](Numbers c, Numbers nu) { return shape(nu, c[0], c[1], c[2]); };
  // Each branch with its own slopes alone: its column stays where those of the other one move.
  recipe.basis = [=](Numbers nu) -> std::vector<std::vector<BasisTerm>> {
    constexpr double kProbe_Nm = 0.1;
    const std::array flexion{nu[0], nu[1], 0.0, 0.0};
    const std::array extension{0.0, 0.0, nu[2], nu[3]};
    const std::array none{0.0, 0.0, 0.0, 0.0};
    return {{{.weight = 1.0 / kProbe_Nm, .parameters = shape(flexion, kProbe_Nm, 0.0, 0.0)}},
            {{.weight = 1.0 / kProbe_Nm, .parameters = shape(extension, 0.0, kProbe_Nm, 0.0)}},
            {{.weight = 1.0 / kProbe_Nm, .parameters = shape(none, 0.0, 0.0, kProbe_Nm)}}};
  };
  if (!at_rest) {
    // Logarithm of a branch over the published one, at the end of the motion where it is largest.
    const auto over = [=](double factor, const char* log, const char* slope, double nu, double angle_rad) {
      const double published = typical.of(slope).initial;
      return std::log(factor) - typical.of(log).initial + published * (std::exp(nu) - 1.0) * angle_rad;
    };
    const double lowest = motion.lowest_position;
    const double highest = lowest + motion.position_range;
    recipe.beyond = [=](Numbers c, Numbers nu) -> std::string {
      const double flexion = over(c[0], "flexion_log_Nm", kSlopes[0], nu[0], lowest);
      const double extension = over(c[1], "extension_log_Nm", kSlopes[2], nu[2], highest);
      return flexion > extension + std::log(kMostOneSided) ? "flexion_log_Nm" : "";
    };
  }
  return recipe;
}

}  // namespace

std::vector<EffectHome> patientEffects() {
  return {
      {.kind = "linear_stiffness",
       .what = "A spring about a rest position: tissue, a cable, an elastic strap.",
       .shows = Shows::kPosition,
       .strengths = {{"stiffness_Nm_rad"}},
       .at_rest = true,
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(linearStiffness(motion)); }},
      {.kind = "passive_knee_moment",
       .what = "Ligaments and muscles that stiffen towards the ends of the range.",
       .shows = Shows::kPosition,
       .log_strengths = {"flexion_log_Nm", "extension_log_Nm"},
       .at_rest = true,
       .of_patient = true,
       .of_knee = true,
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(passiveKneeMoment(motion)); }},
      {.kind = "tremor",
       .what = "A trembling of 3 to 12 Hz.",
       .shows = Shows::kTime,
       .strengths = {{"amplitude_Nm"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             if (motion.duration_s > 0.0 && fastestTremor_Hz(motion) > tremor::kLowest_Hz) {
               all.push_back(tremorRecipe(motion));
             }
           }},
      {.kind = "spasticity",
       .what = "A reflex that resists stretch beyond a speed, after a delay.",
       .shows = Shows::kVelocity,
       .strengths = {{"gain_Nms_rad"}},
       .distinguished_by = "delay_s",
       .of_patient = true,
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(spasticity(motion, 1.0));
             all.push_back(spasticity(motion, -1.0));
           }},
      {.kind = "emg_torque",
       .what = "Torque of a muscle in proportion to its EMG activation, after a delay.",
       .shows = Shows::kActivation,
       .strengths = {{"gain_Nm"}},
       .add =
           [](const Motion& motion, std::span<const int> channels, std::vector<Recipe>& all) {
             for (const int channel : channels) {
               all.push_back(emgTorque(motion, channel));
             }
           }},
  };
}

}  // namespace patella::diagnose
