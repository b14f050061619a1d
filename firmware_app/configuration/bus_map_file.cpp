#include "firmware_app/configuration/bus_map_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "drivers/can/binding_check.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

/// Ten times the highest speed that a joint may be allowed: what goes faster is no motion.
constexpr double kFastestJump_rad_s = 10.0 * boundOf("safety.velocity_rad_s").maximum;

struct BindingBounds {
  Bound scale;
  Bound offset;
};

constexpr BindingBounds kInput{boundOf("input.scale"), boundOf("input.offset")};
constexpr BindingBounds kOutput{boundOf("command.output.scale"), boundOf("command.output.offset")};

can::Binding readBinding(const TomlTable& table, const char* name, bool with_message,
                         const BindingBounds& bounds) {
  can::Binding binding;
  binding.input = table.string(name);
  binding.message = with_message ? table.string("message") : "";
  binding.signal = table.string("signal");
  binding.scale = number(table, bounds.scale, 1.0);
  binding.offset = number(table, bounds.offset, 0.0);
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

void requireAtLeast(const TomlTable& table, const char* key, double timeout_s, const char* period_key,
                    double period_s) {
  if (timeout_s < period_s) {
    throw table.error(key, "value " + formatNumber(timeout_s) + ", expected at least " + period_key +
                               ", which is " + formatNumber(period_s));
  }
}

void readTiming(const TomlTable& table, bool rehearsal, can::BusMap& map) {
  const auto timeout = [&](const Bound& bound, double& value) {
    value = number(table, bound, value, rehearsal);
  };
  timeout(boundOf("checks.encoder_timeout_s"), map.encoder_timeout_s);
  timeout(boundOf("checks.drive_timeout_s"), map.drive_timeout_s);
  timeout(boundOf("checks.emg_timeout_s"), map.emg_timeout_s);
  timeout(boundOf("checks.operator_timeout_s"), map.operator_timeout_s);
  map.encoder_period_s = number(table, boundOf("checks.encoder_period_s"), map.encoder_period_s);
  map.emg_period_s = number(table, boundOf("checks.emg_period_s"), map.emg_period_s);
  requireAtLeast(table, "encoder_timeout_s", map.encoder_timeout_s, "encoder_period_s", map.encoder_period_s);
  requireAtLeast(table, "emg_timeout_s", map.emg_timeout_s, "emg_period_s", map.emg_period_s);
  readInteger(table, boundOf("checks.tolerated_bad_frames"), map.tolerated_bad_frames, rehearsal);
}

void readPositions(const TomlTable& table, can::BusMap& map) {
  map.position_min_rad = number(table, boundOf("checks.position_min_rad"), map.position_min_rad);
  map.position_max_rad = number(table, boundOf("checks.position_max_rad"), map.position_max_rad);
  if (!(map.position_min_rad < map.position_max_rad)) {
    throw table.error("position_min_rad", "value " + formatNumber(map.position_min_rad) +
                                              ", expected less than position_max_rad, which is " +
                                              formatNumber(map.position_max_rad));
  }
  const double fastest_rad = kFastestJump_rad_s * map.encoder_period_s;
  map.position_jump_rad =
      number(table, boundOf("checks.position_jump_rad"), std::min(map.position_jump_rad, fastest_rad));
  if (map.position_jump_rad > fastest_rad) {
    throw table.error("position_jump_rad", "value " + formatNumber(map.position_jump_rad) +
                                               ", expected at most " + formatNumber(fastest_rad) + ", " +
                                               formatNumber(kFastestJump_rad_s) +
                                               " rad/s over encoder_period_s");
  }
}

}  // namespace

BusDescription loadBusDescription(const std::filesystem::path& path,
                                  const std::optional<std::filesystem::path>& dbc, bool rehearsal) {
  return parseBusDescription(readFile(path), path.string(), dbc, rehearsal);
}

BusDescription parseBusDescription(std::string_view text, const std::string& name,
                                   const std::optional<std::filesystem::path>& dbc, bool rehearsal) {
  const TomlDocument document = TomlDocument::parse(text, name);
  const TomlTable& root = document.root();
  BusDescription bus;
  bus.dbc_path = root.path("dbc");
  bus.dbc_path = dbc.value_or(bus.dbc_path);
  const TomlTable checks = root.optionalTable("checks");
  readTiming(checks, rehearsal, bus.map);
  readPositions(checks, bus.map);
  for (const TomlTable& table : root.tables("input")) {
    bus.map.bindings.push_back(readBinding(table, "name", true, kInput));
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
    bus.command.bindings.push_back(readBinding(table, "name", false, kOutput));
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
