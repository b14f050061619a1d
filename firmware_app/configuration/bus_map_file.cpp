#include "firmware_app/configuration/bus_map_file.hpp"

#include <stdexcept>

#include "drivers/can/binding_check.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr Range kTimeout{.minimum = 0.0005, .maximum = 10.0};
constexpr Range kSamplePeriod{.minimum = 1e-5, .maximum = 0.1};
constexpr int kMaxToleratedFrames = 100;

can::Binding readBinding(const TomlTable& table, const char* name, bool with_message) {
  can::Binding binding;
  binding.input = table.string(name);
  binding.message = with_message ? table.string("message") : "";
  binding.signal = table.string("signal");
  binding.scale = table.number("scale", kAnyNumber, 1.0);
  binding.offset = table.number("offset", kAnyNumber, 0.0);
  binding.shared = table.boolean("shared", false);
  binding.scale_reason = table.string("scale_reason", "");
  binding.origin = table.origin();
  return binding;
}

can::Protection readProtection(const TomlTable& table) {
  return {.message = table.string("message"),
          .counter_signal = table.string("counter", ""),
          .crc_signal = table.string("crc", ""),
          .origin = table.origin()};
}

void readTiming(const TomlTable& table, can::BusMap& map) {
  map.encoder_timeout_s = table.number("encoder_timeout_s", kTimeout, map.encoder_timeout_s);
  map.drive_timeout_s = table.number("drive_timeout_s", kTimeout, map.drive_timeout_s);
  map.emg_timeout_s = table.number("emg_timeout_s", kTimeout, map.emg_timeout_s);
  map.operator_timeout_s = table.number("operator_timeout_s", kTimeout, map.operator_timeout_s);
  map.encoder_period_s = table.number("encoder_period_s", kSamplePeriod, map.encoder_period_s);
  map.emg_period_s = table.number("emg_period_s", kSamplePeriod, map.emg_period_s);
  map.position_min_rad = table.number("position_min_rad", kAnyNumber, map.position_min_rad);
  map.position_max_rad = table.number("position_max_rad", kAnyNumber, map.position_max_rad);
  if (!(map.position_min_rad < map.position_max_rad)) {
    throw table.error("position_min_rad", "value " + formatNumber(map.position_min_rad) +
                                              ", expected less than position_max_rad, which is " +
                                              formatNumber(map.position_max_rad));
  }
  map.position_jump_rad = table.number("position_jump_rad", kPositive, map.position_jump_rad);
  map.tolerated_bad_frames = static_cast<int>(
      table.integer("tolerated_bad_frames", 0, kMaxToleratedFrames, map.tolerated_bad_frames));
}

}  // namespace

BusDescription loadBusDescription(const std::filesystem::path& path,
                                  const std::optional<std::filesystem::path>& dbc) {
  return parseBusDescription(readFile(path), path.string(), dbc);
}

BusDescription parseBusDescription(std::string_view text, const std::string& name,
                                   const std::optional<std::filesystem::path>& dbc) {
  const TomlDocument document = TomlDocument::parse(text, name);
  const TomlTable& root = document.root();
  BusDescription bus;
  bus.dbc_path = root.path("dbc");
  bus.dbc_path = dbc.value_or(bus.dbc_path);
  readTiming(root.optionalTable("checks"), bus.map);
  for (const TomlTable& table : root.tables("input")) {
    bus.map.bindings.push_back(readBinding(table, "name", true));
  }
  for (const TomlTable& table : root.tables("protection")) {
    bus.map.protections.push_back(readProtection(table));
  }
  const TomlTable command = root.table("command");
  bus.command.message = command.string("message");
  bus.command.protection.message = bus.command.message;
  bus.command.protection.counter_signal = command.string("counter", "");
  bus.command.protection.crc_signal = command.string("crc", "");
  bus.command.protection.origin = command.origin();
  for (const TomlTable& table : command.tables("output")) {
    bus.command.bindings.push_back(readBinding(table, "name", false));
  }
  document.finish();
  bus.database = can::loadDbc(bus.dbc_path);
  try {
    can::checkBindings(bus.database, bus.map, {&bus.command, 1});
  } catch (const std::invalid_argument& error) {
    throw FileError(error.what());
  }
  return bus;
}

}  // namespace patella::app
