#include "firmware_app/configuration/rig_config.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace patella::app {
namespace {

using Names = std::vector<std::string>;

constexpr double kNanoseconds = 1e9;

void readInteraction(const TomlTable& table, sim::InteractionOptions& options) {
  const std::string kind =
      table.choice("kind", Names{"none", "experiment_1", "experiment_2", "human"}, "none");
  options.kind = kind == "experiment_1"   ? sim::InteractionKind::kExperiment1
                 : kind == "experiment_2" ? sim::InteractionKind::kExperiment2
                 : kind == "human"        ? sim::InteractionKind::kHuman
                                          : sim::InteractionKind::kNone;
  const std::string form = table.choice("form", Names{"as_printed", "corrected"}, "corrected");
  options.form = form == "as_printed" ? sim::InteractionForm::kAsPrinted : sim::InteractionForm::kCorrected;
  options.human_rms_N =
      table.number("human_rms_N", Range{.minimum = 0.0, .maximum = 500.0}, options.human_rms_N);
  options.human_bandwidth_Hz =
      table.number("human_bandwidth_Hz", Range{.minimum = 0.1, .maximum = 20.0, .minimum_open = true},
                   options.human_bandwidth_Hz);
}

void readEncoder(const TomlTable& table, sim::EncoderOptions& options) {
  options.bits_per_turn = static_cast<int>(table.integer("bits_per_turn", 0, 32, options.bits_per_turn));
  options.position_noise_sd_rad =
      table.number("position_noise_sd_rad", kNotNegative, options.position_noise_sd_rad);
  options.velocity_noise_sd_rad_s =
      table.number("velocity_noise_sd_rad_s", kNotNegative, options.velocity_noise_sd_rad_s);
  options.velocity_step_rad_s =
      table.number("velocity_step_rad_s", kNotNegative, options.velocity_step_rad_s);
}

void readDrive(const TomlTable& table, std::size_t joints, sim::DriveOptions& options) {
  const std::vector<double> limits(options.torque_limit_Nm.begin(),
                                   options.torque_limit_Nm.begin() + static_cast<std::ptrdiff_t>(joints));
  const auto torque = table.numbers("torque_limit_Nm", CountRange::exactly(joints), kPositive, limits);
  std::copy(torque.begin(), torque.end(), options.torque_limit_Nm.begin());
  options.bandwidth_Hz = table.number("bandwidth_Hz", kNotNegative, options.bandwidth_Hz);
  options.watchdog_s =
      table.number("watchdog_s", Range{.minimum = 0.001, .maximum = 1.0}, options.watchdog_s);
  options.report_noise_sd_Nm = table.number("report_noise_sd_Nm", kNotNegative, options.report_noise_sd_Nm);
}

void readEmg(const TomlTable& table, sim::RigOptions& rig) {
  const std::string pattern =
      table.choice("pattern", Names{"none", "scheduled", "movement", "paper", "recording"}, "none");
  if (pattern == "recording") {
    rig.emg_log = table.path("log");
    return;
  }
  sim::EmgOptions options = pattern == "scheduled"
                                ? sim::scheduledEmg(table.number("period_s", kPositive, 2.0))
                            : pattern == "movement" ? sim::movementEmg()
                            : pattern == "paper"    ? sim::paperEmg()
                                                    : sim::EmgOptions{};
  options.low_Hz = table.number("low_Hz", kPositive, options.low_Hz);
  options.high_Hz = table.number("high_Hz", kPositive, options.high_Hz);
  options.hum_Hz = table.number("hum_Hz", Range{.minimum = 45.0, .maximum = 65.0}, options.hum_Hz);
  const double hum_mV = table.number("hum_mV", kNotNegative, 0.0);
  for (sim::EmgChannelOptions& channel : options.channels) {
    channel.hum_mV = hum_mV;
  }
  rig.emg = options;
}

void readRigModel(const TomlTable& table, const std::optional<std::filesystem::path>& model,
                  RunConfig& config) {
  config.rig_model = config.model;
  config.rig_model_path = config.model_path;
  if (table.has("model")) {
    config.rig_model_path = table.path("model");
  }
  if (model) {
    config.rig_model_path = *model;
  }
  if (!model && !table.has("model")) {
    return;
  }
  config.rig_model = loadModel(config.rig_model_path);
  if (config.rig_model.joints() != config.model.joints()) {
    const std::string problem = "a mechanism of " + std::to_string(config.rig_model.joints()) +
                                " joints, expected " + std::to_string(config.model.joints()) +
                                " as the loop's model has";
    if (model) {
      throw std::invalid_argument("--rig-model: " + model->string() + ": " + problem);
    }
    throw table.error("model", problem);
  }
}

}  // namespace

void readRigConfig(const TomlTable& table, const std::optional<std::filesystem::path>& model,
                   RunConfig& config) {
  sim::RigOptions& rig = config.rig;
  const auto joints = static_cast<std::size_t>(config.model.joints());
  readRigModel(table, model, config);
  const std::vector<double> zero(joints, 0.0);
  rig.seed =
      static_cast<std::uint64_t>(table.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  rig.initial_q_rad = table.numbers("initial_q_rad", CountRange::exactly(joints), kAnyNumber, zero);
  rig.initial_dq_rad_s = table.numbers("initial_dq_rad_s", CountRange::exactly(joints), kAnyNumber, zero);
  rig.publish_truth = table.boolean("publish_truth", true);
  rig.max_step_s = table.number("max_step_s", Range{.minimum = 1e-6, .maximum = 1e-4}, rig.max_step_s);
  rig.sensor_period_ns = std::llround(kNanoseconds * config.bus.map.encoder_period_s);

  readInteraction(table.optionalTable("interaction"), rig.interaction);
  readEncoder(table.optionalTable("encoder"), rig.encoder);
  readDrive(table.optionalTable("drive"), joints, rig.drive);
  readEmg(table.optionalTable("emg"), rig);
  const TomlTable buttons = table.optionalTable("operator");
  rig.operator_buttons.enable_at_s = buttons.number("enable_at_s", kNotNegative, 0.0);
  const std::vector<double> none;
  rig.operator_buttons.reset_at_s = buttons.numbers("reset_at_s", CountRange{0, 1000}, kNotNegative, none);
}

}  // namespace patella::app
