// Which message travels on which of the loop's buses, from the `bus` keys of a bus map.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/dbc.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// Names of the run's buses by number; a single bus may be without one. Nothing: whoever reads the map knows
/// of no buses, and takes all messages for those of one.
using BusNames = std::optional<std::vector<std::string>>;

class BusAssignment {
 public:
  explicit BusAssignment(const BusNames& names) : names_(names) {}

  /// Number of the bus that the table's key `bus` names; nothing where it names none and there are several.
  /// Throws FileError for a name that is none of them.
  std::optional<std::uint8_t> read(const TomlTable& table) const;

  /// The message is used at `origin`, and travels on that bus where it is known. Throws FileError where it is
  /// on another one already.
  void use(const std::string& message, std::optional<std::uint8_t> bus, const std::string& origin);

  /// Sets Message::bus of all messages that are used. Throws FileError for one whose bus nobody names, and,
  /// naming `map`, for a bus on which none of them travels.
  void apply(const std::string& map, can::Database& database) const;

 private:
  struct Use {
    std::optional<std::uint8_t> bus;
    std::string origin;
  };
  bool several() const noexcept { return names_ && names_->size() > 1; }

  BusNames names_;
  std::map<std::string, Use> uses_;
};

}  // namespace patella::app
