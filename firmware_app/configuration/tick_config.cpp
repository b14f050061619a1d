#include "firmware_app/configuration/tick_config.hpp"

#include <algorithm>
#include <numbers>

#include "core/safety/safety_limiter.hpp"
#include "firmware_app/configuration/monitor_config.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr Range kShare{.minimum = 0.0, .maximum = 1.0};
constexpr double kPi = std::numbers::pi;

JointVector toJointVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

void readNetwork(const TomlTable& table, RunConfig& config) {
  network::InferenceOptions& inference = config.inference;
  const std::string precision =
      table.choice("precision", std::vector<std::string>{"float32", "int16"}, "float32");
  inference.precision = precision == "int16" ? network::Precision::kInt16 : network::Precision::kFloat32;
  inference.int16_tolerance = table.number("int16_tolerance", kPositive, inference.int16_tolerance);
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
  e.band_low_Hz = table.number("band_low_Hz", kPositive, e.band_low_Hz);
  e.band_high_Hz = table.number("band_high_Hz", kPositive, e.band_high_Hz);
  e.mains_Hz = table.number("mains_Hz", Range{.minimum = 0.0, .maximum = 60.0}, e.mains_Hz);
  e.envelope_Hz = table.number("envelope_Hz", kPositive, e.envelope_Hz);
  e.twitch_s = table.number("twitch_s", Range{.minimum = 0.0, .maximum = 1.0}, e.twitch_s);
  const auto channels = CountRange::exactly(kMaxEmgChannels);
  const std::vector<double> mvc(kMaxEmgChannels, 1.0);
  const std::vector<double> zero(kMaxEmgChannels, 0.0);
  const auto mvc_mV = table.numbers("mvc_mV", channels, kPositive, mvc);
  const auto rest_mV = table.numbers("rest_mV", channels, kNotNegative, zero);
  const auto shape = table.numbers("shape", channels, Range{.minimum = -3.0, .maximum = 0.0}, zero);
  const Range gain{.minimum = -emg::EmgTorqueMap::kMaxGain_Nm, .maximum = emg::EmgTorqueMap::kMaxGain_Nm};
  for (std::size_t i = 0; i < kMaxEmgChannels; ++i) {
    e.channel[i] = {.mvc_mV = mvc_mV[i], .rest_mV = rest_mV[i], .shape = shape[i]};
  }
  for (int joint = 0; joint < config.model.joints(); ++joint) {
    const auto gains = table.numbers("gain" + std::to_string(joint + 1) + "_Nm", channels, gain, zero);
    std::copy(gains.begin(), gains.end(), config.tick.emg_gain_Nm[static_cast<std::size_t>(joint)].begin());
  }
}

void readControl(const TomlTable& table, RunConfig& config) {
  control::ControlGains& g = config.tick.gains;
  const auto joints = static_cast<std::size_t>(config.model.joints());
  const std::vector<double> zero(joints, 0.0);
  g.gravity = table.number("gravity", kShare, 0.0);
  g.model = table.number("model", kShare, 0.0);
  g.emg = table.number("emg", Range{.minimum = -5.0, .maximum = 5.0}, 0.0);
  g.compensation = table.number("compensation", kShare, 0.0);
  g.stiffness_Nm_rad = toJointVector(table.numbers("stiffness_Nm_rad", CountRange::exactly(joints),
                                                   Range{.minimum = 0.0, .maximum = 10000.0}, zero));
  g.damping_Nms_rad = toJointVector(table.numbers("damping_Nms_rad", CountRange::exactly(joints),
                                                  Range{.minimum = 0.0, .maximum = 1000.0}, zero));
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

// Three arrays of one length, a component an element; without phases, those that keep the peak low.
control::MultisineMotion readMultisine(const TomlTable& table, Range angle) {
  control::MultisineMotion motion{.offset_rad = table.number("offset_rad", angle), .components = {}};
  const auto frequency_Hz =
      table.numbers("frequency_Hz", CountRange{1, control::MultisineMotion::kMaxComponents},
                    Range{.minimum = 0.0, .maximum = 5.0});
  const std::size_t count = frequency_Hz.size();
  const auto amplitude_rad =
      table.numbers("amplitude_rad", CountRange::exactly(count), Range{.minimum = 0.0, .maximum = kPi});
  std::vector<double> phase_rad;
  for (std::size_t k = 0; k < count; ++k) {
    phase_rad.push_back(control::schroederPhase_rad(k, count));
  }
  phase_rad = table.numbers("phase_rad", CountRange::exactly(count), angle, phase_rad);
  double sum_rad = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    motion.components.push_back(
        {.amplitude_rad = amplitude_rad[k], .frequency_Hz = frequency_Hz[k], .phase_rad = phase_rad[k]});
    sum_rad += amplitude_rad[k];
  }
  if (sum_rad > kPi) {
    throw table.error("amplitude_rad", "sum " + formatNumber(sum_rad) + ", expected a sum of " +
                                           formatNumber(kPi) + " at most");
  }
  return motion;
}

control::JointMotion readMotion(const TomlTable& table) {
  const Range angle{.minimum = -2.0 * kPi, .maximum = 2.0 * kPi};
  const std::string motion =
      table.choice("motion", std::vector<std::string>{"hold", "sinusoid", "multisine", "move"});
  if (motion == "sinusoid") {
    return control::SinusoidMotion{
        .offset_rad = table.number("offset_rad", angle),
        .amplitude_rad = table.number("amplitude_rad", Range{.minimum = 0.0, .maximum = kPi}),
        .frequency_Hz = table.number("frequency_Hz", Range{.minimum = 0.0, .maximum = 20.0}),
        .phase_rad = table.number("phase_rad", angle, 0.0)};
  }
  if (motion == "multisine") {
    return readMultisine(table, angle);
  }
  if (motion == "move") {
    return control::MoveMotion{
        .target_rad = table.number("target_rad", angle),
        .duration_s = table.number("duration_s", Range{.minimum = 0.1, .maximum = 600.0})};
  }
  control::HoldMotion hold;
  if (table.has("position_rad")) {
    hold.position_rad = table.number("position_rad", angle);
  }
  return hold;
}

control::ReferenceSettings readReference(const TomlTable& table, const RunConfig& config) {
  control::ReferenceSettings r;
  r.blend_s = table.number("blend_s", Range{.minimum = 0.1, .maximum = 60.0}, r.blend_s);
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

void readSafety(const TomlTable& table, RunConfig& config) {
  const auto joints = static_cast<std::size_t>(config.model.joints());
  const auto perJoint = [&](const char* key, double ceiling) {
    return table.numbers(key, CountRange::exactly(joints),
                         Range{.minimum = 0.0, .maximum = ceiling, .minimum_open = true});
  };
  const Range angle{.minimum = -safety::kCeilingAngle_rad, .maximum = safety::kCeilingAngle_rad};
  const auto torque = perJoint("torque_Nm", safety::kCeilingTorque_Nm);
  const auto rate = perJoint("torque_rate_Nm_s", safety::kCeilingTorqueRate_Nm_s);
  const auto velocity = perJoint("velocity_rad_s", safety::kCeilingVelocity_rad_s);
  const auto lower = table.numbers("q_min_rad", CountRange::exactly(joints), angle);
  const auto upper = table.numbers("q_max_rad", CountRange::exactly(joints), angle);
  const std::vector<double> margins(joints, safety::JointLimits{}.soft_margin_rad);
  const auto margin = table.numbers("soft_margin_rad", CountRange::exactly(joints), kNotNegative, margins);
  safety::SafetyLimits& limits = config.tick.limits;
  for (std::size_t i = 0; i < joints; ++i) {
    limits.joint[i] = {.torque_Nm = torque[i],
                       .torque_rate_Nm_s = rate[i],
                       .velocity_rad_s = velocity[i],
                       .q_min_rad = lower[i],
                       .q_max_rad = upper[i],
                       .soft_margin_rad = margin[i]};
  }
  limits.saturation_timeout_s =
      table.number("saturation_timeout_s", Range{.minimum = 0.001, .maximum = safety::kCeilingSaturation_s},
                   limits.saturation_timeout_s);
  config.tick.healthy_ticks =
      static_cast<int>(table.integer("healthy_ticks", 1, 10000, config.tick.healthy_ticks));
  config.tick.monitors = readMonitors(table, joints);
  config.loop.overruns_tolerated =
      static_cast<int>(table.integer("overruns_tolerated", 0, 100, config.loop.overruns_tolerated));
  config.loop.missed_share_tolerated =
      table.number("missed_share_tolerated",
                   Range{.minimum = 0.001, .maximum = LoopOptions::kCeilingMissedShare},
                   config.loop.missed_share_tolerated);
  config.loop.send_failures_tolerated =
      static_cast<int>(table.integer("send_failures_tolerated", 0, 100, config.loop.send_failures_tolerated));
}

}  // namespace

void readTickConfig(const TomlTable& root, RunConfig& config) {
  config.tick.encoder_period_s = config.bus.map.encoder_period_s;
  config.tick.period_s = 1.0 / config.loop.rate_Hz;
  config.observer = readEstimation(root.optionalTable("estimation"), config.model.joints(), config.tick);
  readNetwork(root.optionalTable("network"), config);
  readEmg(root.optionalTable("emg"), config);
  readControl(root.optionalTable("control"), config);
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
