#include "firmware_app/configuration/canopen_config.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/canopen/data_sheet.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

using Names = std::vector<std::string>;

void requireLonger(const TomlTable& table, const char* timeout_key, double timeout_s, const char* period_key,
                   double period_s) {
  // Two periods: one beat may come late.
  if (timeout_s < 2.0 * period_s) {
    throw table.error(timeout_key, "value " + formatNumber(timeout_s) + ", expected at least twice " +
                                       period_key + ", which is " + formatNumber(period_s));
  }
}

void readNetwork(const TomlTable& table, bool rehearsal, canopen::NetworkSettings& network) {
  readInteger(table, boundOf("canopen.master_node"), network.master_node);
  network.heartbeat_period_s =
      number(table, boundOf("canopen.heartbeat_period_s"), network.heartbeat_period_s);
  network.heartbeat_timeout_s =
      number(table, boundOf("canopen.heartbeat_timeout_s"), network.heartbeat_timeout_s, rehearsal);
  network.node_heartbeat_period_s =
      number(table, boundOf("canopen.node_heartbeat_period_s"), network.node_heartbeat_period_s);
  network.node_heartbeat_timeout_s =
      number(table, boundOf("canopen.node_heartbeat_timeout_s"), network.node_heartbeat_timeout_s, rehearsal);
  requireLonger(table, "heartbeat_timeout_s", network.heartbeat_timeout_s, "heartbeat_period_s",
                network.heartbeat_period_s);
  requireLonger(table, "node_heartbeat_timeout_s", network.node_heartbeat_timeout_s,
                "node_heartbeat_period_s", network.node_heartbeat_period_s);
}

canopen::DriveSettings readDrive(const TomlTable& table) {
  constexpr double kMilli = 1e-3;
  constexpr double kMicro = 1e-6;
  canopen::DriveSettings drive;
  drive.origin = table.origin();
  drive.joint = static_cast<int>(integer(table, boundOf("cia402.joint"))) - 1;
  drive.node = static_cast<int>(integer(table, boundOf("cia402.node")));
  drive.rated_torque_Nm = number(table, boundOf("cia402.rated_torque_Nm"));
  const bool milli = table.choice("rated_torque_unit", Names{"mN.m", "uN.m"}) == "mN.m";
  drive.rated_torque_unit_Nm = milli ? kMilli : kMicro;
  drive.gear = number(table, boundOf("cia402.gear"), drive.gear);
  readInteger(table, boundOf("cia402.direction"), drive.direction);
  if (drive.direction == 0) {
    throw table.error("direction", "value 0, expected 1 or -1");
  }
  drive.counts_per_turn = number(table, boundOf("cia402.counts_per_turn"));
  drive.zero_angle_rad = number(table, boundOf("cia402.zero_angle_rad"), drive.zero_angle_rad);
  drive.enter_timeout_s = number(table, boundOf("cia402.enter_timeout_s"), drive.enter_timeout_s);
  return drive;
}

void readSheet(const TomlTable& table, canopen::DriveSettings& drive, BusDescription& bus) {
  const std::filesystem::path path = table.existing("eds");
  const canopen::DataSheet sheet = canopen::loadDataSheet(path, drive.node);
  canopen::requireTorqueDrive(sheet);
  drive.vendor = sheet.vendor;
  drive.product = sheet.product;
  drive.parameters = canopen::parametersOf(sheet);
  bus.data_sheets.push_back(path);
}

void requireOwnNode(const TomlTable& table, const canopen::DriveSettings& drive,
                    const canopen::CanopenMap& canopen) {
  const bool taken =
      std::any_of(canopen.drives.begin(), canopen.drives.end(),
                  [&drive](const canopen::DriveSettings& other) { return other.node == drive.node; });
  if (taken || drive.node == canopen.network.master_node) {
    throw table.error("node", "value " + std::to_string(drive.node) + ", which is another drive's or " +
                                  "canopen.master_node, expected a number of its own");
  }
}

}  // namespace

std::vector<std::optional<std::uint8_t>> readCanopen(const TomlTable& root, bool rehearsal,
                                                     const BusAssignment& assignment, BusDescription& bus) {
  std::vector<std::optional<std::uint8_t>> buses;
  const std::vector<TomlTable> tables = root.tables("cia402");
  if (!tables.empty()) {
    readNetwork(root.optionalTable("canopen"), rehearsal, bus.canopen.network);
  }
  for (const TomlTable& table : tables) {
    canopen::DriveSettings drive = readDrive(table);
    readSheet(table, drive, bus);
    requireOwnNode(table, drive, bus.canopen);
    bus.canopen.drives.push_back(drive);
    buses.push_back(assignment.read(table));
  }
  return buses;
}

void requireHeartbeats(const canopen::NetworkSettings& network, double tick_s) {
  constexpr double kRounding = 1e-6;
  const auto require = [tick_s](const char* key, double value_s, int ticks, const char* of) {
    const double least_s = ticks * tick_s;
    if (value_s < (1.0 - kRounding) * least_s) {
      throw std::invalid_argument("key 'canopen." + std::string(key) + "': value " + formatNumber(value_s) +
                                  ", expected at least " + formatNumber(least_s) + ", " + of +
                                  " at loop.rate_Hz of " + formatNumber(1.0 / tick_s));
    }
  };
  require("heartbeat_period_s", network.heartbeat_period_s, 1, "a tick");
  require("heartbeat_timeout_s", network.heartbeat_timeout_s, 2, "two ticks");
  require("node_heartbeat_timeout_s", network.node_heartbeat_timeout_s, 2, "two ticks");
}

}  // namespace patella::app
