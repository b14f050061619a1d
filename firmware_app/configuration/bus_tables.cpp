#include "firmware_app/configuration/bus_tables.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "drivers/can/candump_log.hpp"
#include "firmware_app/files/bounded.hpp"

namespace patella::app {
namespace {

void requireInterface(const std::string& name, const BusSettings& bus) {
  if (name.empty() || name.size() > can::kMaxInterfaceName ||
      name.find_first_of(" \t/") != std::string::npos) {
    const std::string of = bus.name.empty() ? "" : " for bus '" + bus.name + "'";  // the only one has no name
    throw std::invalid_argument("value '" + name + "'" + of +
                                ", expected the name of an interface, of at most " +
                                std::to_string(can::kMaxInterfaceName) + " characters");
  }
}

void requireDifferent(const std::vector<BusSettings>& buses) {
  for (std::size_t i = 0; i < buses.size(); ++i) {
    requireInterface(buses[i].interface, buses[i]);
    for (std::size_t k = 0; k < i; ++k) {
      if (buses[k].interface == buses[i].interface) {
        throw std::invalid_argument("value '" + buses[i].interface + "' for bus '" + buses[i].name +
                                    "', which is that of bus '" + buses[k].name +
                                    "', expected an interface for each bus");
      }
    }
  }
}

BusSettings readBus(const TomlTable& table, const std::vector<BusSettings>& others) {
  BusSettings bus;
  bus.name = table.string("name");
  if (std::any_of(others.begin(), others.end(),
                  [&](const BusSettings& other) { return other.name == bus.name; })) {
    throw table.error("name", "value '" + bus.name + "', which is another bus's, expected a name of its own");
  }
  bus.interface = table.string("interface");
  bus.bitrate = static_cast<std::uint32_t>(integer(table, boundOf("bus.bitrate_bit_s"), 0));
  return bus;
}

// [[bus]]: what is not of one bus alone stands beside them.
void readBuses(const TomlTable& root, RunConfig& config) {
  const std::vector<TomlTable> tables = root.tables("bus");
  if (tables.empty() || tables.size() > can::kMaxBuses) {
    throw root.error(
        "bus", std::to_string(tables.size()) + " tables, expected 1 to " + std::to_string(can::kMaxBuses));
  }
  config.buses.clear();
  for (const TomlTable& table : tables) {
    config.buses.push_back(readBus(table, config.buses));
    try {
      requireDifferent(config.buses);
    } catch (const std::invalid_argument& error) {
      throw table.error("interface", error.what());
    }
  }
}

}  // namespace

Backend parseBackend(const std::string& text, bool several_buses) {
  if (text == "sim") {
    return {BackendKind::kSim, ""};
  }
  if (text == "can" && several_buses) {
    return {BackendKind::kCan, ""};
  }
  for (const auto& [prefix, kind] :
       {std::pair{"can:", BackendKind::kCan}, std::pair{"replay:", BackendKind::kReplay}}) {
    const std::string start = prefix;
    if (text.starts_with(start) && text.size() > start.size()) {
      return {kind, text.substr(start.size())};
    }
  }
  throw std::invalid_argument("value '" + text + "', expected sim, " +
                              (several_buses ? "can, can:INTERFACE,INTERFACE" : "can:INTERFACE") +
                              " or replay:LOG");
}

void readBusTables(const TomlTable& root, RunConfig& config) {
  const bool several = root.has("bus") && !root.isTable("bus");
  const TomlTable table = several ? root : root.table("bus");
  if (several) {
    readBuses(root, config);
  } else {
    config.buses = {{.name = "",
                     .interface = "sim0",
                     .bitrate = static_cast<std::uint32_t>(integer(table, boundOf("bus.bitrate_bit_s"), 0))}};
  }
  try {
    config.backend = parseBackend(table.string("backend", "sim"), several);
  } catch (const std::invalid_argument& error) {
    throw table.error("backend", error.what());
  }
  if (config.backend.kind == BackendKind::kReplay) {
    std::string& log = config.backend.target;
    log = (config.path.parent_path() / log).lexically_normal().string();
  }
  config.bus_map_path = table.existing(several ? "bus_map" : "map");
}

void placeBuses(RunConfig& config) {
  if (config.backend.kind != BackendKind::kCan) {
    return;
  }
  std::string& target = config.backend.target;
  std::vector<std::string> interfaces;
  for (std::size_t at = 0; !target.empty() && at <= target.size();) {
    const std::size_t end = std::min(target.find(',', at), target.size());
    interfaces.push_back(target.substr(at, end - at));
    at = end + 1;
  }
  if (!interfaces.empty() && interfaces.size() != config.buses.size()) {
    throw std::invalid_argument("--backend: value 'can:" + target + "', expected " +
                                std::to_string(config.buses.size()) + " interfaces, one for each [[bus]]");
  }
  target.clear();
  for (std::size_t i = 0; i < config.buses.size(); ++i) {
    BusSettings& bus = config.buses[i];
    bus.interface = interfaces.empty() ? bus.interface : interfaces[i];
    target += (target.empty() ? "" : ",") + bus.interface;
  }
  try {
    requireDifferent(config.buses);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--backend: ") + error.what());
  }
}

std::vector<std::string> busNames(const std::vector<BusSettings>& buses) {
  std::vector<std::string> names;
  for (const BusSettings& bus : buses) {
    names.push_back(bus.name);
  }
  return names;
}

}  // namespace patella::app
