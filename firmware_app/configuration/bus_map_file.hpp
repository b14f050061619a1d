// The file that binds a DBC to the loop: which signal of which message is which input.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/canopen/canopen_map.hpp"
#include "firmware_app/configuration/bus_assignment.hpp"

namespace patella::app {

struct BusDescription {
  std::filesystem::path dbc_path;
  can::Database database;
  can::BusMap map;
  std::vector<can::CommandMap> commands;  ///< one for each drive, or one for all of them
  canopen::CanopenMap canopen;            ///< drives of [[cia402]], whose PDOs are among inputs and commands
  std::vector<std::filesystem::path> data_sheets;  ///< EDS or DCF of each of them
};

/// A message in CAN FD that the loop sends or needs on the bus of that number; empty where all are classic.
std::string fdMessage(const BusDescription& bus, std::size_t number);

/// Reads the map and the DBC it names. Throws FileError naming file, line and key; a DBC's own errors carry
/// its file, line and column. `dbc` is read in place of the one that the map names. In a rehearsal, which
/// moves no motor, timeouts may be longer. `buses`: those that `bus` keys of the map may name; each has to
/// carry something.
BusDescription loadBusDescription(const std::filesystem::path& path,
                                  const std::optional<std::filesystem::path>& dbc = {},
                                  bool rehearsal = false, const BusNames& buses = {});
/// `name` stands for the map's file in messages.
BusDescription parseBusDescription(std::string_view text, const std::string& name,
                                   const std::optional<std::filesystem::path>& dbc = {},
                                   bool rehearsal = false, const BusNames& buses = {});

}  // namespace patella::app
