#include <algorithm>
#include <cmath>

#include "tools/diagnose/effects/recipe_parts.hpp"

namespace patella::diagnose {
namespace {

Recipe payload(const Motion& motion) {
  Recipe recipe = start("payload", motion, {true});
  recipe.nonlinear = {{.lower = 0.05, .upper = 0.8}};
  recipe.grid = product({{0.1, 0.2, 0.3, 0.4}});
  recipe.parameters = [](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("payload").set("mass_kg", c[0]).set("distance_m", nu[0]);
  };
  return recipe;
}

// Cycles per radian: from one and a half over the range to what is within the band while the joint is slow.
double coarsestRipple(const Motion& motion) {
  return std::max(0.5, 1.5 / motion.position_range);
}

double finestRipple(const Motion& motion) {
  /// A joint that moves to and fro is slower for an eighth of the time, which a ripple needs to show in.
  constexpr double kSlow = 1.0 / 6.0;
  return std::min(60.0, motion.band_Hz / (kSlow * motion.velocity_rms));
}

bool rippleFits(const Motion& motion) {
  return coarsestRipple(motion) <= finestRipple(motion);
}

Recipe torqueRipple(const Motion& motion) {
  const double step = 0.4 / motion.position_range;
  return oscillation("torque_ripple", motion, "cycles_per_rad",
                     range(coarsestRipple(motion), finestRipple(motion), step));
}

/// No drive is later.
constexpr double kLatest_s = 0.05;

Recipe timing(const char* kind, const Motion& motion, const char* name, double upper_s) {
  Recipe recipe = start(kind, motion, {});
  recipe.nonlinear = {{.lower = 1e-4, .upper = upper_s}};
  recipe.grid = product({{0.002, 0.006, 0.015, 0.03}});
  recipe.proportional = true;
  recipe.by_asked_torque = true;
  recipe.parameters = [=](Numbers, Numbers nu) -> std::vector<double> {
    return Parameters(kind).set(name, nu[0]);
  };
  return recipe;
}

Recipe encoderOffset(const Motion& motion) {
  Recipe recipe = start("encoder_offset", motion, {});
  recipe.nonlinear = {{.lower = -0.25, .upper = 0.25}};
  recipe.grid = product({{-0.02, 0.02}});
  recipe.proportional = true;
  recipe.shifts_angle = true;
  recipe.parameters = [](Numbers, Numbers nu) -> std::vector<double> {
    return Parameters("encoder_offset").set("offset_rad", nu[0]);
  };
  return recipe;
}

// Softer than any drive: what asks for it is a torque at one frequency, which a spring that is tuned to it
// can give, too. The springs of series elastic drives give a third of a radian at their largest torque.
std::string tooSoft(Numbers parameters, double torque_rms) {
  constexpr double kMostGiven_rad = 0.5;
  const auto& catalogued = model::findEffect("transmission_elasticity")->parameters;
  for (std::size_t p = 0; p < catalogued.size(); ++p) {
    if (catalogued[p].name == "stiffness_Nm_rad" &&
        parameters[p] <= std::max(catalogued[p].minimum, torque_rms / kMostGiven_rad)) {
      return std::string(catalogued[p].name);
    }
  }
  return {};
}

/// Of what moves with a joint.
constexpr double kLightest_kg_m2 = 1e-5;

// ν = (resonance of the drive against its spring in rad/s, logarithms of the drive's inertia and of the
// damping ratio over what is common): from within the band to where the spring could as well be rigid. On an
// axis that moves freely only the resonance shows: which part of the mass is the drive's does not.
Recipe transmissionElasticity(const Motion& motion) {
  /// The drive's part of what moves: within the spread a tenth to nearly all, as inertias are matched.
  constexpr double kShareOfInertia = 0.3;
  constexpr double kDampingRatio = 0.1;
  const double spread = std::log(3.0);
  Recipe recipe = start("transmission_elasticity", motion, {});
  recipe.contains = {"rotor_inertia"};
  const double usual = kShareOfInertia * std::max(kLightest_kg_m2, motion.inertia);
  recipe.nonlinear = {{.lower = 4.0, .upper = 200.0, .step = 0.5},
                      {.lower = -4.5 * spread, .upper = 1.8 * spread, .step = 0.05, .spread = spread},
                      {.lower = -2.0 * spread, .upper = 2.0 * spread, .step = 0.1, .spread = spread}};
  recipe.grid = product({{10.0, 15.0, 22.0, 32.0, 45.0, 65.0, 100.0}, {-1.0, 0.5}, {0.0, 1.0}});
  recipe.parameters = [=](Numbers, Numbers nu) -> std::vector<double> {
    const double rotor = usual * std::exp(nu[1]);
    return Parameters("transmission_elasticity")
        .set("stiffness_Nm_rad", nu[0] * nu[0] * rotor)
        .set("rotor_inertia_kg_m2", rotor)
        .set("damping_Nms_rad", 2.0 * kDampingRatio * std::exp(nu[2]) * nu[0] * rotor);
  };
  recipe.by_factors = true;
  recipe.beyond = [parameters = recipe.parameters, torque_rms = motion.torque_rms](Numbers c, Numbers nu) {
    return tooSoft(parameters(c, nu), torque_rms);
  };
  return recipe;
}

// The motor rings in a contact at about 80 Hz, far above the band, and leaves it more slowly than it came.
// Neither is known of a gear, and both change where a light link gives way. So they are fitted, within what
// is common, and the other parameters are never known better than to 10 and 15 %: they were off by as much on
// simulated rigs whose contacts rang at 40 and 100 Hz with damping ratios of 0.1 and 0.5.
// ν = logarithms of (gap times inertia of the drive, that inertia, the contact's damping ratio and frequency
// over what is common). A torque τ carries the motor across the gap in sqrt(2 gap·inertia/τ) and loses no
// momentum on the way, so that the first alone says how late torque arrives; the second adds a rotor. Valleys
// lie so close that between two of them the motor is never late by more than a contact's bump in the band is
// wide.
Recipe backlash(const Motion& motion) {
  constexpr double kContact_rad_s = 500.0, kDampingRatio = 0.3;
  const double damping_spread = std::log(2.5);
  const double contact_spread = std::log(1.6);
  constexpr double kFinest = 2e-5, kCoarsest = 1.5e-2;         // of gap times share of inertia, rad
  constexpr double kSmallestRatio = 1.1, kLargestRatio = 1.6;  // from one of them to the next
  constexpr double kFlightStep_s = 0.012;
  /// Impacts leave bumps this wide.
  constexpr double kStep = 0.05;
  Recipe recipe = start("backlash", motion, {});
  recipe.contains = {"rotor_inertia"};
  const double inertia = std::max(kLightest_kg_m2, motion.inertia);
  recipe.nonlinear = {
      {.lower = std::log(0.5 * kFinest * inertia),
       .upper = std::log(2.0 * kCoarsest * inertia),
       .step = kStep,
       .assumption = 0.1},
      {.lower = std::log(0.002 * inertia),
       .upper = std::log(2.0 * inertia),
       .step = kStep,
       .assumption = 0.15},
      {.lower = -2.0 * damping_spread, .upper = 2.0 * damping_spread, .step = 0.1, .spread = damping_spread},
      {.lower = -2.5 * contact_spread, .upper = 2.5 * contact_spread, .step = 0.1, .spread = contact_spread}};
  const double finest = std::log(kFinest * inertia), coarsest = std::log(kCoarsest * inertia);
  std::vector<double> flights;
  for (double flight = finest; flight < coarsest;) {
    flights.push_back(flight);
    const double flight_s = std::sqrt(2.0 * std::exp(flight) / motion.torque_rms);
    flight += std::clamp(2.0 * std::log1p(kFlightStep_s / flight_s), std::log(kSmallestRatio),
                         std::log(kLargestRatio));
  }
  recipe.grid = product({flights, {std::log(0.04 * inertia), std::log(0.15 * inertia)}, {0.0}, {0.0}});
  recipe.valleys =
      product({flights, range(std::log(0.02 * inertia), std::log(0.4 * inertia), 0.25), {0.0}, {0.0}});
  recipe.parameters = [](Numbers, Numbers nu) -> std::vector<double> {
    const double rotor = std::exp(nu[1]);
    const double contact_rad_s = kContact_rad_s * std::exp(nu[3]);
    return Parameters("backlash")
        .set("gap_rad", std::exp(nu[0]) / rotor)
        .set("rotor_inertia_kg_m2", rotor)
        .set("stiffness_Nm_rad", rotor * contact_rad_s * contact_rad_s)
        .set("damping_Nms_rad", 2.0 * kDampingRatio * std::exp(nu[2]) * rotor * contact_rad_s);
  };
  recipe.by_factors = true;
  recipe.assumed = {"stiffness_Nm_rad", "damping_Nms_rad"};
  return recipe;
}

Recipe thermalDrift(const Motion& motion, const char* what, double smoothing) {
  Recipe recipe = start("thermal_drift", motion, {false});
  recipe.variant = what;
  const double duration_s = motion.duration_s;
  // Much slower than the recording is long, it grows in straight proportion to time, whatever the constant.
  recipe.nonlinear = {
      {.lower = std::max(10.0, 0.15 * duration_s), .upper = 3.0 * duration_s + 20.0, .open_above = true}};
  recipe.grid = product({{std::max(10.0, 0.25 * duration_s), std::max(12.0, duration_s)}});
  recipe.parameters = [=](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("thermal_drift")
        .set("offset_Nm", 0.0)
        .set("friction_Nm", 0.0)
        .set("viscous_Nms_rad", 0.0)
        .set(what, c[0])
        .set("time_constant_s", nu[0])
        .set(kSmoothing, smoothing);
  };
  return recipe;
}

// (1 + gain_error) u = τ for all torques τ that the drive's u has to give, so that u = (1 − c) τ.
Recipe torqueGain(const Motion& motion) {
  Recipe recipe = start("torque_gain", motion, {false});
  // Anything large that goes with the torque would pass for a gain of almost −1.
  recipe.largest = 0.5;
  recipe.scales_all = true;
  recipe.parameters = [](Numbers c, Numbers) -> std::vector<double> {
    return Parameters("torque_gain").set("gain_error", c[0] / (1.0 - c[0]));
  };
  return recipe;
}

}  // namespace

std::vector<EffectHome> machineEffects() {
  return {
      {.kind = "payload",
       .what = "A mass that is carried along, at a distance from the joint.",
       .shows = Shows::kPosition,
       .strengths = {{"mass_kg"}},
       .at_rest = true,
       .along_segment = true,
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(payload(motion)); }},
      {.kind = "rotor_inertia",
       .what = "Inertia of a motor, through its gear.",
       .shows = Shows::kAcceleration,
       .strengths = {{"inertia_kg_m2"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(single("rotor_inertia", motion, "inertia_kg_m2", true));
           }},
      {.kind = "transmission_elasticity",
       .what = "A motor behind a spring: belts, harmonic drives, series elastic drives.",
       .shows = Shows::kTorqueRate,
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(transmissionElasticity(motion)); }},
      {.kind = "backlash",
       .what = "Play in a gear: the motor crosses a gap where the torque changes sign.",
       .shows = Shows::kTorque,
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(backlash(motion)); }},
      {.kind = "torque_ripple",
       .what = "Torque that goes with the position of a motor or gear: cogging, teeth.",
       .shows = Shows::kPosition,
       .strengths = {{"amplitude_Nm"}},
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             if (rippleFits(motion)) {
               all.push_back(torqueRipple(motion));
             }
           }},
      {.kind = "torque_gain",
       .what = "A drive that gives more or less than it was told.",
       .shows = Shows::kTorque,
       .strengths = {{"gain_error"}},
       .distinguished_by = "gain_error",
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(torqueGain(motion)); }},
      {.kind = "torque_bias",
       .what = "A constant torque: the zero of a current sensor, a counterweight.",
       .shows = Shows::kTime,
       .strengths = {{"bias_Nm"}},
       .at_rest = true,
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(single("torque_bias", motion, "bias_Nm", false));
           }},
      {.kind = "actuator_lag",
       .what = "A drive that follows its command like a low-pass of first order.",
       .shows = Shows::kTorqueRate,
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(timing("actuator_lag", motion, "time_constant_s", kLatest_s));
           }},
      {.kind = "actuator_delay",
       .what = "A drive that acts late by a fixed time.",
       .shows = Shows::kTorqueRate,
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             all.push_back(timing("actuator_delay", motion, "delay_s", kLatest_s));
           }},
      {.kind = "encoder_offset",
       .what = "A zero of the encoder that is not where the model has it.",
       .shows = Shows::kPosition,
       .add = [](const Motion& motion, std::span<const int>,
                 std::vector<Recipe>& all) { all.push_back(encoderOffset(motion)); }},
      {.kind = "thermal_drift",
       .what = "Bias or friction that changes as the machine warms up.",
       .shows = Shows::kTime,
       .strengths = {{"offset_Nm"}, {"friction_Nm"}, {"viscous_Nms_rad"}},
       .distinguished_by = "time_constant_s",
       .told_by_torque = true,
       .add =
           [](const Motion& motion, std::span<const int>, std::vector<Recipe>& all) {
             if (motion.duration_s > 0.0) {
               for (const char* what : {"offset_Nm", "friction_Nm", "viscous_Nms_rad"}) {
                 all.push_back(thermalDrift(motion, what, motion.smoothing_rad_s));
               }
             }
           }},
  };
}

}  // namespace patella::diagnose
