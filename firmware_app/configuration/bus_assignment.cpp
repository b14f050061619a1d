#include "firmware_app/configuration/bus_assignment.hpp"

#include <algorithm>
#include <cstddef>

#include "drivers/joined.hpp"

namespace patella::app {

std::optional<std::uint8_t> BusAssignment::read(const TomlTable& table) const {
  const std::string name = table.string("bus", "");
  if (name.empty()) {
    return several() ? std::nullopt : std::optional<std::uint8_t>(0);
  }
  if (!names_) {
    return 0;
  }
  const auto found = std::find(names_->begin(), names_->end(), name);
  if (found == names_->end()) {
    const bool named = !names_->empty() && !names_->front().empty();
    throw table.error("bus", "value '" + name + "', expected " +
                                 (named ? "a bus of the run configuration: " + joined(*names_, ", ")
                                        : "no 'bus': the run configuration has one bus, without a name"));
  }
  return static_cast<std::uint8_t>(found - names_->begin());
}

void BusAssignment::use(const std::string& message, std::optional<std::uint8_t> bus,
                        const std::string& origin) {
  const auto [known, first] = uses_.try_emplace(message, Use{bus, origin});
  Use& use = known->second;
  if (!first && bus && use.bus && *bus != *use.bus) {
    throw FileError(origin + ": message '" + message + "' is on bus '" + (*names_)[*bus] + "', and on bus '" +
                    (*names_)[*use.bus] + "' already (" + use.origin +
                    "); expected one bus for each message");
  }
  if (bus && !use.bus) {
    use = {bus, origin};
  }
}

void BusAssignment::apply(const std::string& map, can::Database& database) const {
  if (!several()) {
    return;
  }
  std::vector<bool> used(names_->size());
  for (const auto& [name, use] : uses_) {
    if (!use.bus) {
      throw FileError(use.origin + ": nothing says on which bus message '" + name +
                      "' travels, expected 'bus' with one of its uses: " + joined(*names_, ", "));
    }
    used[*use.bus] = true;
    for (can::Message& message : database.messages) {
      message.bus = message.name == name ? *use.bus : message.bus;
    }
  }
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused != used.end()) {
    throw FileError(map + ": no message travels on bus '" +
                    (*names_)[static_cast<std::size_t>(unused - used.begin())] +
                    "', expected an input or a command with it, or no such [[bus]] in the run configuration");
  }
}

}  // namespace patella::app
