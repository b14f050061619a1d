// A database from its file, and what it holds, by name and by identifier.
#include <algorithm>
#include <stdexcept>

#include "drivers/can/dbc.hpp"
#include "drivers/files/regular_file.hpp"
#include "drivers/joined.hpp"

namespace patella::can {

Database loadDbc(const std::filesystem::path& file) {
  try {
    return parseDbc(files::readWhole(file, files::kBusDescription), file.string());
  } catch (const DbcError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw DbcError(error.what());
  }
}

const Signal* Message::find(std::string_view signal) const noexcept {
  const auto found = std::find_if(signals.begin(), signals.end(),
                                  [&](const Signal& candidate) { return candidate.name == signal; });
  return found == signals.end() ? nullptr : &*found;
}

const Message* Database::find(std::string_view message) const noexcept {
  const auto found = std::find_if(messages.begin(), messages.end(),
                                  [&](const Message& candidate) { return candidate.name == message; });
  return found == messages.end() ? nullptr : &*found;
}

const Message* Database::find(std::uint32_t id, bool extended) const noexcept {
  const auto found = std::find_if(messages.begin(), messages.end(), [&](const Message& candidate) {
    return candidate.id == id && candidate.extended == extended;
  });
  return found == messages.end() ? nullptr : &*found;
}

const Message& Database::message(std::string_view name) const {
  if (const Message* found = find(name))
    return *found;
  throw std::invalid_argument(source + ": no message '" + std::string(name) +
                              "'; there are: " + joined(messages, ", ", &Message::name));
}

}  // namespace patella::can
