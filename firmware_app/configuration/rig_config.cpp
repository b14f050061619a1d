#include "firmware_app/configuration/rig_config.hpp"

#include <cmath>
#include <stdexcept>

#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/model_file.hpp"

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
  options.human_rms_N = number(table, boundOf("rig.interaction.human_rms_N"), options.human_rms_N);
  options.human_bandwidth_Hz =
      number(table, boundOf("rig.interaction.human_bandwidth_Hz"), options.human_bandwidth_Hz);
}

void readEncoder(const TomlTable& table, sim::EncoderOptions& options) {
  readInteger(table, boundOf("rig.encoder.bits_per_turn"), options.bits_per_turn);
  options.position_noise_sd_rad =
      number(table, boundOf("rig.encoder.position_noise_sd_rad"), options.position_noise_sd_rad);
  options.velocity_noise_sd_rad_s =
      number(table, boundOf("rig.encoder.velocity_noise_sd_rad_s"), options.velocity_noise_sd_rad_s);
  options.velocity_step_rad_s =
      number(table, boundOf("rig.encoder.velocity_step_rad_s"), options.velocity_step_rad_s);
}

void readDrive(const TomlTable& table, std::size_t joints, sim::DriveOptions& options) {
  const std::vector<double> limits(options.torque_limit_Nm.begin(),
                                   options.torque_limit_Nm.begin() + static_cast<std::ptrdiff_t>(joints));
  const auto torque =
      numbers(table, boundOf("rig.drive.torque_limit_Nm"), CountRange::exactly(joints), limits);
  std::copy(torque.begin(), torque.end(), options.torque_limit_Nm.begin());
  options.bandwidth_Hz = number(table, boundOf("rig.drive.bandwidth_Hz"), options.bandwidth_Hz);
  options.watchdog_s = number(table, boundOf("rig.drive.watchdog_s"), options.watchdog_s);
  options.report_noise_sd_Nm =
      number(table, boundOf("rig.drive.report_noise_sd_Nm"), options.report_noise_sd_Nm);
}

void readMitModel(const TomlTable& table, sim::FieldDriveOptions& options) {
  readInteger(table, boundOf("rig.drive_model.master_id"), options.master_id);
  options.position_range_rad =
      number(table, boundOf("rig.drive_model.position_range_rad"), options.position_range_rad);
  options.velocity_range_rad_s =
      number(table, boundOf("rig.drive_model.velocity_range_rad_s"), options.velocity_range_rad_s);
  options.torque_range_Nm =
      number(table, boundOf("rig.drive_model.torque_range_Nm"), options.torque_range_Nm);
}

void readCia402Model(const TomlTable& table, sim::FieldDriveOptions& options) {
  options.rated_torque_Nm =
      number(table, boundOf("rig.drive_model.rated_torque_Nm"), options.rated_torque_Nm);
  options.rated_torque_unit_Nm =
      table.choice("rated_torque_unit", Names{"mN.m", "uN.m"}, "mN.m") == "mN.m" ? 1e-3 : 1e-6;
  options.gear = number(table, boundOf("rig.drive_model.gear"), options.gear);
  readInteger(table, boundOf("rig.drive_model.direction"), options.direction);
  options.counts_per_turn =
      number(table, boundOf("rig.drive_model.counts_per_turn"), options.counts_per_turn);
  options.zero_angle_rad = number(table, boundOf("rig.drive_model.zero_angle_rad"), options.zero_angle_rad);
}

void requireNode(const TomlTable& table, int id, int first, int last) {
  if (id < first || id > last) {
    throw table.error("id", "value " + std::to_string(id) + ", expected a node, " + std::to_string(first) +
                                " to " + std::to_string(last));
  }
}

sim::FieldDriveOptions readDriveModel(const TomlTable& table) {
  constexpr int kLastOdrive = 63;
  constexpr int kLastCanopenNode = 127;
  sim::FieldDriveOptions options;
  const std::string kind = table.choice("kind", Names{"mit", "odrive", "cia402"});
  readInteger(table, boundOf("rig.drive_model.id"), options.id);
  if (kind == "mit") {
    options.kind = sim::FieldDriveKind::kMit;
    readMitModel(table, options);
  } else if (kind == "cia402") {
    options.kind = sim::FieldDriveKind::kCia402;
    readCia402Model(table, options);
    requireNode(table, options.id, 1, kLastCanopenNode);
  } else {
    options.kind = sim::FieldDriveKind::kOdrive;
    options.heartbeat_period_s =
        number(table, boundOf("rig.drive_model.heartbeat_period_s"), options.heartbeat_period_s);
    requireNode(table, options.id, 0, kLastOdrive);
  }
  options.torque_limit_Nm =
      number(table, boundOf("rig.drive_model.torque_limit_Nm"), options.torque_limit_Nm);
  options.bandwidth_Hz = number(table, boundOf("rig.drive_model.bandwidth_Hz"), options.bandwidth_Hz);
  options.watchdog_s = number(table, boundOf("rig.drive_model.watchdog_s"), options.watchdog_s);
  options.enable_delay_s = number(table, boundOf("rig.drive_model.enable_delay_s"), options.enable_delay_s);
  return options;
}

// A drive is on the bus of the command that moves its joint.
void placeDrives(const BusDescription& bus, std::vector<sim::FieldDriveOptions>& drives) {
  for (const can::CommandMap& command : bus.commands) {
    for (const can::Binding& binding : command.bindings) {
      for (std::size_t joint = 0; joint < drives.size(); ++joint) {
        if (binding.input == "torque_Nm." + std::to_string(joint + 1)) {
          drives[joint].bus = bus.database.message(command.message).bus;
        }
      }
    }
  }
}

void readEmg(const TomlTable& table, sim::RigOptions& rig) {
  const std::string pattern =
      table.choice("pattern", Names{"none", "scheduled", "movement", "paper", "recording"}, "none");
  if (pattern == "recording") {
    rig.emg_log = table.path("log");
    return;
  }
  sim::EmgOptions options = pattern == "scheduled"
                                ? sim::scheduledEmg(number(table, boundOf("rig.emg.period_s"), 2.0))
                            : pattern == "movement" ? sim::movementEmg()
                            : pattern == "paper"    ? sim::paperEmg()
                                                    : sim::EmgOptions{};
  options.low_Hz = number(table, boundOf("rig.emg.low_Hz"), options.low_Hz);
  options.high_Hz = number(table, boundOf("rig.emg.high_Hz"), options.high_Hz);
  options.hum_Hz = number(table, boundOf("rig.emg.hum_Hz"), options.hum_Hz);
  const double hum_mV = number(table, boundOf("rig.emg.hum_mV"), 0.0);
  for (sim::EmgChannelOptions& channel : options.channels) {
    channel.hum_mV = hum_mV;
  }
  rig.emg = options;
}

void readRigModel(const TomlTable& table, const std::optional<std::filesystem::path>& model,
                  RunConfig& config) {
  config.rig_model = config.model;
  config.rig_model_path = config.model_path;
  config.rig_model_urdfs = config.model_urdfs;
  if (model) {
    table.string("model", "");
    config.rig_model_path = *model;
  } else if (table.has("model")) {
    config.rig_model_path = table.existing("model");
  }
  if (!model && !table.has("model")) {
    return;
  }
  config.rig_model = loadModel(config.rig_model_path, &config.rig_model_urdfs);
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
  readInteger(table, boundOf("rig.seed"), rig.seed);
  rig.initial_q_rad = numbers(table, boundOf("rig.initial_q_rad"), CountRange::exactly(joints), zero);
  rig.initial_dq_rad_s = numbers(table, boundOf("rig.initial_dq_rad_s"), CountRange::exactly(joints), zero);
  rig.publish_truth = table.boolean("publish_truth", true);
  rig.max_step_s = number(table, boundOf("rig.max_step_s"), rig.max_step_s);
  rig.sensor_period_ns = std::llround(kNanoseconds * config.bus.map.encoder_period_s);

  readInteraction(table.optionalTable("interaction"), rig.interaction);
  readEncoder(table.optionalTable("encoder"), rig.encoder);
  readDrive(table.optionalTable("drive"), joints, rig.drive);
  for (const TomlTable& drive : table.tables("drive_model")) {
    rig.field_drives.push_back(readDriveModel(drive));
  }
  if (!rig.field_drives.empty() && rig.field_drives.size() != joints) {
    throw table.error("drive_model", std::to_string(rig.field_drives.size()) +
                                         " tables, expected one for each of " + std::to_string(joints) +
                                         " joints");
  }
  placeDrives(config.bus, rig.field_drives);
  rig.buses = config.buses.size();
  readEmg(table.optionalTable("emg"), rig);
  const TomlTable buttons = table.optionalTable("operator");
  rig.operator_buttons.enable_at_s = number(buttons, boundOf("rig.operator.enable_at_s"), 0.0);
  const std::vector<double> none;
  rig.operator_buttons.reset_at_s =
      numbers(buttons, boundOf("rig.operator.reset_at_s"), CountRange{0, 1000}, none);
}

}  // namespace patella::app
