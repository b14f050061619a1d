#include "tools/diagnose/recipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/model/effect.hpp"

namespace patella::diagnose {
namespace {

using Numbers = std::span<const double>;

// How a joint moved, which scales where the search looks.
struct Motion {
  int joint = 0;
  double velocity_rms = 0.0;
  double lowest_position = 0.0;
  double position_range = 0.0;
  double torque_rms = 0.0;
  double duration_s = 0.0;
  double band_Hz = 0.0;
  double inertia = 0.0;          ///< mean of the joint's own, kg·m²
  double smoothing_rad_s = 0.0;  ///< of its dry friction
};

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
      motion.duration_s = data.isStatic() ? 0.0 : std::max(motion.duration_s, state.time_s);
    }
    count += static_cast<double>(series.states.size());
  }
  motion.velocity_rms = std::sqrt(velocity / count);
  motion.torque_rms = std::sqrt(torque / count);
  motion.lowest_position = low;
  motion.position_range = high - low;
  motion.inertia /= count;
  return motion;
}

// A kind's parameters by name; what is not set has its descriptor's initial value.
class Parameters {
 public:
  explicit Parameters(std::string_view kind) : descriptor_(model::findEffect(kind)) {
    for (const model::EffectParameter& parameter : descriptor_->parameters) {
      values_.push_back(parameter.initial);
    }
  }
  Parameters& set(std::string_view name, double value) {
    const std::size_t index = indexOf(name);
    const model::EffectParameter& range = descriptor_->parameters[index];
    values_[index] = std::clamp(value, range.minimum, range.maximum);
    return *this;
  }
  operator std::vector<double>() const { return values_; }
  const model::EffectParameter& of(std::string_view name) const {
    return descriptor_->parameters[indexOf(name)];
  }

 private:
  std::size_t indexOf(std::string_view name) const {
    const auto found = std::find_if(descriptor_->parameters.begin(), descriptor_->parameters.end(),
                                    [name](const auto& parameter) { return parameter.name == name; });
    if (found == descriptor_->parameters.end()) {
      throw std::logic_error(fmt::format("effect {} has no parameter {}", descriptor_->kind, name));
    }
    return static_cast<std::size_t>(found - descriptor_->parameters.begin());
  }

  const model::EffectDescriptor* descriptor_;
  std::vector<double> values_;
};

constexpr const char* kSmoothing = "smoothing_velocity_rad_s";

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

std::vector<std::vector<double>> product(const std::vector<std::vector<double>>& axes) {
  std::vector<std::vector<double>> points{{}};
  for (const std::vector<double>& axis : axes) {
    std::vector<std::vector<double>> grown;
    for (const auto& point : points) {
      for (const double value : axis) {
        grown.push_back(point);
        grown.back().push_back(value);
      }
    }
    points = std::move(grown);
  }
  return points;
}

Recipe start(const char* kind, const Motion& motion, std::vector<bool> nonnegative) {
  Recipe recipe;
  recipe.kind = kind;
  recipe.joint = motion.joint;
  recipe.nonnegative = std::move(nonnegative);
  recipe.grid = {{}};
  return recipe;
}

// One strength and nothing else.
Recipe single(const char* kind, const Motion& motion, const char* strength, bool nonnegative,
              double smoothing = 0.0) {
  Recipe recipe = start(kind, motion, {nonnegative});
  recipe.contains = {kind};
  recipe.parameters = [=](Numbers c, Numbers) -> std::vector<double> {
    Parameters parameters(kind);
    parameters.set(strength, c[0]);
    if (smoothing > 0.0) {
      parameters.set(kSmoothing, smoothing);
    }
    return parameters;
  };
  return recipe;
}

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
  recipe.nonlinear = {{.lower = 0.02 * rms, .upper = 1.0 * rms}};
  recipe.grid = product({{0.06 * rms, 0.15 * rms, 0.35 * rms}});
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
  recipe.nonlinear = {{.lower = 0.001 * range, .upper = 0.1 * range}};
  recipe.grid = product({{0.005 * range, 0.02 * range, 0.06 * range}});
  recipe.parameters = [](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("presliding_hysteresis").set("level_Nm", c[0]).set("stiffness_Nm_rad", c[0] / nu[0]);
  };
  return recipe;
}

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
  recipe.beyond = [=](Numbers c) -> std::string {
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

Recipe payload(const Motion& motion) {
  Recipe recipe = start("payload", motion, {true});
  recipe.nonlinear = {{.lower = 0.05, .upper = 0.8}};
  recipe.grid = product({{0.1, 0.2, 0.3, 0.4}});
  recipe.parameters = [](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters("payload").set("mass_kg", c[0]).set("distance_m", nu[0]);
  };
  return recipe;
}

// Amplitude and phase as the amplitudes of sine and cosine.
Recipe oscillation(const char* kind, const Motion& motion, const char* frequency,
                   std::vector<double> frequencies) {
  Recipe recipe = start(kind, motion, {false, false});
  const double step = frequencies.size() > 1 ? frequencies[1] - frequencies[0] : 0.1;
  recipe.nonlinear = {{.lower = frequencies.front() - step, .upper = frequencies.back() + step}};
  recipe.grid = product({std::move(frequencies)});
  recipe.parameters = [=](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters(kind)
        .set("amplitude_Nm", std::hypot(c[0], c[1]))
        .set(frequency, nu[0])
        .set("phase_rad", std::atan2(c[1], c[0]));
  };
  return recipe;
}

std::vector<double> range(double from, double to, double step) {
  std::vector<double> values;
  for (double value = from; value <= to; value += step) {
    values.push_back(value);
  }
  return values;
}

Recipe tremor(const Motion& motion) {
  // Finer than the width of a line of this length, which would fall between two points.
  return oscillation("tremor", motion, "frequency_Hz",
                     range(3.0, std::min(12.0, 0.9 * motion.band_Hz), 0.6 / motion.duration_s));
}

// Cycles per radian: from one and a half over the range to what the joint's speed keeps within the band.
double coarsestRipple(const Motion& motion) {
  return std::max(0.5, 1.5 / motion.position_range);
}

double finestRipple(const Motion& motion) {
  return std::min(60.0, motion.band_Hz / (1.2 * motion.velocity_rms));
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
  recipe.parameters = [](Numbers, Numbers nu) -> std::vector<double> {
    return Parameters("encoder_offset").set("offset_rad", nu[0]);
  };
  return recipe;
}

// ν = (resonance of the drive against its spring, inertia of the drive): from within the band to where the
// spring could as well be rigid.
Recipe transmissionElasticity(const Motion& motion) {
  constexpr double kDampingRatio = 0.1;
  Recipe recipe = start("transmission_elasticity", motion, {});
  recipe.contains = {"rotor_inertia"};
  const double inertia = std::max(0.001, motion.inertia);
  recipe.nonlinear = {{.lower = 4.0, .upper = 200.0}, {.lower = 0.002 * inertia, .upper = 2.0 * inertia}};
  recipe.grid =
      product({{10.0, 15.0, 22.0, 32.0, 45.0, 65.0, 100.0}, {0.05 * inertia, 0.2 * inertia, 0.7 * inertia}});
  recipe.parameters = [](Numbers, Numbers nu) -> std::vector<double> {
    return Parameters("transmission_elasticity")
        .set("stiffness_Nm_rad", nu[0] * nu[0] * nu[1])
        .set("rotor_inertia_kg_m2", nu[1])
        .set("damping_Nms_rad", 2.0 * kDampingRatio * nu[0] * nu[1]);
  };
  return recipe;
}

// The contact is as stiff as it takes for the motor to ring in it at about 100 Hz, far above the band.
Recipe backlash(const Motion& motion) {
  constexpr double kContact_rad_s = 600.0;
  constexpr double kDampingRatio = 0.3;
  Recipe recipe = start("backlash", motion, {});
  recipe.contains = {"rotor_inertia"};
  recipe.nonlinear = {{.lower = 0.0005, .upper = 0.2}, {.lower = 0.0005, .upper = 5.0}};
  const double inertia = std::max(0.001, motion.inertia);
  recipe.grid = product({{0.004, 0.012, 0.04}, {0.01 * inertia, 0.05 * inertia, 0.2 * inertia}});
  recipe.parameters = [](Numbers, Numbers nu) -> std::vector<double> {
    return Parameters("backlash")
        .set("gap_rad", nu[0])
        .set("rotor_inertia_kg_m2", nu[1])
        .set("stiffness_Nm_rad", nu[1] * kContact_rad_s * kContact_rad_s)
        .set("damping_Nms_rad", 2.0 * kDampingRatio * nu[1] * kContact_rad_s);
  };
  return recipe;
}

Recipe spasticity(const Motion& motion, double direction) {
  Recipe recipe = start("spasticity", motion, {true});
  recipe.variant = direction > 0.0 ? "direction +1" : "direction -1";
  const double rms = motion.velocity_rms;
  recipe.nonlinear = {{.lower = 0.1 * rms, .upper = 2.0 * rms}, {.lower = 0.0, .upper = 0.1}};
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

Recipe thermalDrift(const Motion& motion, const char* what, double smoothing) {
  Recipe recipe = start("thermal_drift", motion, {false});
  recipe.variant = what;
  const double duration_s = motion.duration_s;
  recipe.nonlinear = {{.lower = std::max(10.0, 0.15 * duration_s), .upper = 3.0 * duration_s + 20.0}};
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
  return recipe;
}

void addKind(std::string_view kind, const Motion& motion, std::span<const int> channels,
             std::vector<Recipe>& all) {
  const double smoothing = motion.smoothing_rad_s;
  const bool timed = motion.duration_s > 0.0;
  if (kind == "viscous_friction") {
    all.push_back(single("viscous_friction", motion, "coefficient_Nms_rad", true));
  } else if (kind == "coulomb_friction") {
    all.push_back(single("coulomb_friction", motion, "level_Nm", true, smoothing));
    all.push_back(gradualFriction(motion, smoothing));
  } else if (kind == "asymmetric_friction") {
    all.push_back(asymmetricFriction(motion, smoothing, false));
    all.push_back(asymmetricFriction(motion, smoothing, true));
  } else if (kind == "stribeck_friction") {
    all.push_back(stribeckFriction(motion, smoothing));
  } else if (kind == "load_dependent_friction") {
    all.push_back(single("load_dependent_friction", motion, "coefficient", true, smoothing));
  } else if (kind == "presliding_hysteresis") {
    all.push_back(preslidingHysteresis(motion));
  } else if (kind == "linear_stiffness") {
    all.push_back(linearStiffness(motion));
  } else if (kind == "passive_knee_moment") {
    all.push_back(passiveKneeMoment(motion));
  } else if (kind == "payload") {
    all.push_back(payload(motion));
  } else if (kind == "rotor_inertia") {
    all.push_back(single("rotor_inertia", motion, "inertia_kg_m2", true));
  } else if (kind == "transmission_elasticity") {
    all.push_back(transmissionElasticity(motion));
  } else if (kind == "backlash") {
    all.push_back(backlash(motion));
  } else if (kind == "torque_ripple" && rippleFits(motion)) {
    all.push_back(torqueRipple(motion));
  } else if (kind == "torque_gain") {
    all.push_back(single("torque_gain", motion, "gain_error", false));
    // Anything large that goes with the torque would pass for a gain of almost −1.
    all.back().largest = 0.3;
  } else if (kind == "torque_bias") {
    all.push_back(single("torque_bias", motion, "bias_Nm", false));
  } else if (kind == "actuator_lag") {
    all.push_back(timing("actuator_lag", motion, "time_constant_s", kLatest_s));
  } else if (kind == "actuator_delay") {
    all.push_back(timing("actuator_delay", motion, "delay_s", kLatest_s));
  } else if (kind == "encoder_offset") {
    all.push_back(encoderOffset(motion));
  } else if (kind == "tremor" && timed && 0.9 * motion.band_Hz > 3.0) {
    all.push_back(tremor(motion));
  } else if (kind == "spasticity") {
    all.push_back(spasticity(motion, 1.0));
    all.push_back(spasticity(motion, -1.0));
  } else if (kind == "emg_torque") {
    for (const int channel : channels) {
      all.push_back(emgTorque(motion, channel));
    }
  } else if (kind == "thermal_drift" && timed) {
    for (const char* what : {"offset_Nm", "friction_Nm", "viscous_Nms_rad"}) {
      all.push_back(thermalDrift(motion, what, smoothing));
    }
  }
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
        addKind(kind, motion, channels, all);
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

}  // namespace patella::diagnose
