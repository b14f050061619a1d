#include "firmware_app/configuration/tick_config.hpp"

#include <algorithm>
#include <array>

#include "drivers/can/input_table.hpp"
#include "firmware_app/configuration/monitor_config.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr Bound kOffset = boundOf("reference.joint.offset_rad");
constexpr Bound kAmplitude = boundOf("reference.joint.amplitude_rad");
constexpr Bound kFrequency = boundOf("reference.joint.frequency_Hz");
constexpr Bound kPhase = boundOf("reference.joint.phase_rad");

JointVector toJointVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void readNetwork(const TomlTable& table, RunConfig& config) {
  network::InferenceOptions& inference = config.inference;
  const std::string precision =
      table.choice("precision", std::vector<std::string>{"float32", "int16"}, "float32");
  inference.precision = precision == "int16" ? network::Precision::kInt16 : network::Precision::kFloat32;
  inference.int16_tolerance = number(table, boundOf("network.int16_tolerance"), inference.int16_tolerance);
  std::vector<std::string> names = {"auto"};
  const std::vector<network::InstructionSet> sets = network::availableInstructionSets();
  for (const network::InstructionSet set : sets) {
    names.push_back(network::nameOf(set));
  }
  const std::string name = table.choice("instruction_set", names, "auto");
  for (const network::InstructionSet set : sets) {
    if (network::nameOf(set) == name) {
      inference.instruction_set = set;
    }
  }
}

void readEmg(const TomlTable& table, RunConfig& config) {
  emg::EmgSettings& e = config.tick.emg;
  e.rate_Hz = 1.0 / config.bus.map.emg_period_s;
  e.channels = kMaxEmgChannels;
  e.bypass = table.boolean("bypass", e.bypass);
  e.band_low_Hz = number(table, boundOf("emg.band_low_Hz"), e.band_low_Hz);
  e.band_high_Hz = number(table, boundOf("emg.band_high_Hz"), e.band_high_Hz);
  e.mains_Hz = number(table, boundOf("emg.mains_Hz"), e.mains_Hz);
  e.envelope_Hz = number(table, boundOf("emg.envelope_Hz"), e.envelope_Hz);
  e.twitch_s = number(table, boundOf("emg.twitch_s"), e.twitch_s);
  const auto channels = CountRange::exactly(kMaxEmgChannels);
  const std::vector<double> mvc(kMaxEmgChannels, 1.0);
  const std::vector<double> zero(kMaxEmgChannels, 0.0);
  const auto mvc_mV = numbers(table, boundOf("emg.mvc_mV"), channels, mvc);
  const auto rest_mV = numbers(table, boundOf("emg.rest_mV"), channels, zero);
  const auto shape = numbers(table, boundOf("emg.shape"), channels, zero);
  constexpr std::array<Bound, kMaxJoints> kGain{
      boundOf("emg.gain1_Nm"), boundOf("emg.gain2_Nm"), boundOf("emg.gain3_Nm"), boundOf("emg.gain4_Nm"),
      boundOf("emg.gain5_Nm"), boundOf("emg.gain6_Nm"), boundOf("emg.gain7_Nm"), boundOf("emg.gain8_Nm")};
  for (std::size_t i = 0; i < kMaxEmgChannels; ++i) {
    e.channel[i] = {.mvc_mV = mvc_mV[i], .rest_mV = rest_mV[i], .shape = shape[i]};
  }
  for (std::size_t joint = 0; joint < static_cast<std::size_t>(config.model.joints()); ++joint) {
    const auto gains = numbers(table, kGain[joint], channels, zero);
    std::copy(gains.begin(), gains.end(), config.tick.emg_gain_Nm[joint].begin());
  }
}

void readControl(const TomlTable& table, RunConfig& config) {
  control::ControlGains& g = config.tick.gains;
  const auto joints = static_cast<std::size_t>(config.model.joints());
  const std::vector<double> zero(joints, 0.0);
  g.gravity = number(table, boundOf("control.gravity"), 0.0);
  g.model = number(table, boundOf("control.model"), 0.0);
  g.emg = number(table, boundOf("control.emg"), 0.0);
  g.compensation = number(table, boundOf("control.compensation"), 0.0);
  g.stiffness_Nm_rad =
      toJointVector(numbers(table, boundOf("control.stiffness_Nm_rad"), CountRange::exactly(joints), zero));
  g.damping_Nms_rad =
      toJointVector(numbers(table, boundOf("control.damping_Nms_rad"), CountRange::exactly(joints), zero));
  const std::string source =
      table.choice("compensation_source", std::vector<std::string>{"none", "sampler", "network"}, "sampler");
  config.tick.compensation = source == "network"   ? tick::CompensationSource::kNetwork
                             : source == "sampler" ? tick::CompensationSource::kSampler
                                                   : tick::CompensationSource::kNone;
  if (source == "network" && !config.weights) {
    throw table.error("compensation_source",
                      "value 'network', expected 'none' or 'sampler' as no weights are given");
  }
}

// What no electrode hears would assist with nothing, and nobody would be told.
void requireElectrodes(const TomlTable& control, const RunConfig& config) {
  if (config.tick.gains.emg == 0.0) {
    return;
  }
  std::array<bool, kMaxEmgChannels> bound{};
  for (const can::Binding& binding : config.bus.map.bindings) {
    const can::InputId input = can::inputOf(binding.input, kMaxJoints);
    if (input.input == can::Input::kEmg) {
      bound[static_cast<std::size_t>(input.index)] = true;
    }
  }
  const auto refusal = [&](const std::string& expected) {
    return control.error("emg", "value " + formatNumber(config.tick.gains.emg) + ", expected 0, or " +
                                    expected + " of " + config.bus_map_path.string());
  };
  if (std::none_of(bound.begin(), bound.end(), [](bool is) { return is; })) {
    throw refusal("an input emg_mV");
  }
  for (std::size_t joint = 0; joint < static_cast<std::size_t>(config.model.joints()); ++joint) {
    for (std::size_t channel = 0; channel < bound.size(); ++channel) {
      if (config.tick.emg_gain_Nm[joint][channel] != 0.0 && !bound[channel]) {
        const std::string number = std::to_string(channel + 1);
        throw refusal("an input emg_mV." + number + ", to which emg.gain" + std::to_string(joint + 1) +
                      "_Nm gives torque,");
      }
    }
  }
}

// Three arrays of one length, a component an element; without phases, those that keep the peak low.
control::MultisineMotion readMultisine(const TomlTable& table) {
  control::MultisineMotion motion{.offset_rad = number(table, kOffset), .components = {}};
  const auto frequency_Hz =
      numbers(table, kFrequency, CountRange{1, control::MultisineMotion::kMaxComponents});
  const std::size_t count = frequency_Hz.size();
  const auto amplitude_rad = numbers(table, kAmplitude, CountRange::exactly(count));
  std::vector<double> phase_rad;
  for (std::size_t k = 0; k < count; ++k) {
    phase_rad.push_back(control::schroederPhase_rad(k, count));
  }
  phase_rad = numbers(table, kPhase, CountRange::exactly(count), phase_rad);
  double sum_rad = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    motion.components.push_back(
        {.amplitude_rad = amplitude_rad[k], .frequency_Hz = frequency_Hz[k], .phase_rad = phase_rad[k]});
    sum_rad += amplitude_rad[k];
  }
  if (sum_rad > kAmplitude.maximum) {
    throw table.error("amplitude_rad", "sum " + formatNumber(sum_rad) + ", expected a sum of " +
                                           formatNumber(kAmplitude.maximum) + " at most");
  }
  return motion;
}

control::JointMotion readMotion(const TomlTable& table) {
  const std::string motion =
      table.choice("motion", std::vector<std::string>{"hold", "sinusoid", "multisine", "move"});
  if (motion == "sinusoid") {
    return control::SinusoidMotion{.offset_rad = number(table, kOffset),
                                   .amplitude_rad = number(table, kAmplitude),
                                   .frequency_Hz = number(table, kFrequency),
                                   .phase_rad = number(table, kPhase, 0.0)};
  }
  if (motion == "multisine") {
    return readMultisine(table);
  }
  if (motion == "move") {
    return control::MoveMotion{.target_rad = number(table, boundOf("reference.joint.target_rad")),
                               .duration_s = number(table, boundOf("reference.joint.duration_s"))};
  }
  control::HoldMotion hold;
  if (table.has("position_rad")) {
    hold.position_rad = number(table, boundOf("reference.joint.position_rad"));
  }
  return hold;
}

control::ReferenceSettings readReference(const TomlTable& table, const RunConfig& config) {
  control::ReferenceSettings r;
  r.blend_s = number(table, boundOf("reference.blend_s"), r.blend_s);
  const std::vector<TomlTable> joints = table.tables("joint");
  const auto expected = static_cast<std::size_t>(config.model.joints());
  if (!joints.empty() && joints.size() != expected) {
    throw table.error("joint", std::to_string(joints.size()) + " tables, expected " +
                                   std::to_string(expected) + ", one for each joint of the model");
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    r.motion[i] = readMotion(joints[i]);
  }
  return r;
}

// A position beyond what the bus map lets pass is no position: the leg would be stopped within its range.
void requirePlausible(const TomlTable& table, const safety::JointLimits& joint, const RunConfig& config) {
  const can::BusMap& map = config.bus.map;
  const auto refusal = [&](const char* key, double value_rad, const std::string& expected, double end_rad) {
    return table.error(key, "value " + formatNumber(value_rad) + ", expected " + expected + " of " +
                                config.bus_map_path.string() + ", which is " + formatNumber(end_rad));
  };
  if (joint.q_min_rad < map.position_min_rad) {
    throw refusal("q_min_rad", joint.q_min_rad, "at least checks.position_min_rad", map.position_min_rad);
  }
  if (joint.q_max_rad > map.position_max_rad) {
    throw refusal("q_max_rad", joint.q_max_rad, "at most checks.position_max_rad", map.position_max_rad);
  }
}

void readSafety(const TomlTable& table, RunConfig& config) {
  const auto joints = static_cast<std::size_t>(config.model.joints());
  const auto perJoint = [&](const Bound& bound) {
    return numbers(table, bound, CountRange::exactly(joints));
  };
  const auto torque = perJoint(boundOf("safety.torque_Nm"));
  const auto rate = perJoint(boundOf("safety.torque_rate_Nm_s"));
  const auto velocity = perJoint(boundOf("safety.velocity_rad_s"));
  const auto lower = perJoint(boundOf("safety.q_min_rad"));
  const auto upper = perJoint(boundOf("safety.q_max_rad"));
  for (std::size_t i = 0; i < joints; ++i) {
    if (!(lower[i] < upper[i])) {
      throw table.error("q_max_rad", "value " + formatNumber(upper[i]) + " of joint " +
                                         std::to_string(i + 1) + ", expected more than q_min_rad, which is " +
                                         formatNumber(lower[i]));
    }
  }
  const std::vector<double> margins(joints, safety::JointLimits{}.soft_margin_rad);
  const auto margin = numbers(table, boundOf("safety.soft_margin_rad"), CountRange::exactly(joints), margins);
  safety::SafetyLimits& limits = config.tick.limits;
  for (std::size_t i = 0; i < joints; ++i) {
    limits.joint[i] = {.torque_Nm = torque[i],
                       .torque_rate_Nm_s = rate[i],
                       .velocity_rad_s = velocity[i],
                       .q_min_rad = lower[i],
                       .q_max_rad = upper[i],
                       .soft_margin_rad = margin[i]};
    requirePlausible(table, limits.joint[i], config);
  }
  limits.saturation_timeout_s =
      number(table, boundOf("safety.saturation_timeout_s"), limits.saturation_timeout_s);
  readInteger(table, boundOf("safety.healthy_ticks"), config.tick.healthy_ticks);
  config.tick.monitors = readMonitors(table, joints, config.rehearsal);
  readInteger(table, boundOf("safety.overruns_tolerated"), config.loop.overruns_tolerated, config.rehearsal);
  config.loop.missed_share_tolerated = number(table, boundOf("safety.missed_share_tolerated"),
                                              config.loop.missed_share_tolerated, config.rehearsal);
  readInteger(table, boundOf("safety.send_failures_tolerated"), config.loop.send_failures_tolerated,
              config.rehearsal);
}

}  // namespace

void readTickConfig(const TomlTable& root, RunConfig& config) {
  config.tick.encoder_period_s = config.bus.map.encoder_period_s;
  config.tick.period_s = 1.0 / config.loop.rate_Hz;
  config.observer = readEstimation(root.optionalTable("estimation"), config.model.joints(), config.tick);
  readNetwork(root.optionalTable("network"), config);
  readEmg(root.optionalTable("emg"), config);
  const TomlTable control = root.optionalTable("control");
  readControl(control, config);
  requireElectrodes(control, config);
  config.tick.reference = readReference(root.optionalTable("reference"), config);
  readSafety(root.table("safety"), config);
}

void loadReference(const std::filesystem::path& path, RunConfig& config) {
  const TomlDocument document = TomlDocument::load(path);
  config.tick.reference = readReference(document.root(), config);
  document.finish();
  config.reference_path = path;
}

}  // namespace patella::app
