#include "firmware_app/configuration/dbc_names.hpp"

#include <string>
#include <vector>

#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

template <typename Named>
std::string expectedOf(const std::string& value, const std::string& what, const std::vector<Named>& known) {
  std::vector<std::string> names;
  for (const Named& one : known) {
    names.push_back(one.name);
  }
  return "value '" + value + "', expected " + what + ": " + quotedList(names) + suggestion(value, names);
}

const can::Message& messageAt(const TomlTable& table, const can::Database& database) {
  const std::string name = table.string("message");
  const can::Message* found = database.find(name);
  if (found == nullptr) {
    throw table.error("message", expectedOf(name, "a message of " + database.source, database.messages));
  }
  return *found;
}

void checkSignals(const TomlTable& table, const can::Message& message,
                  std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    const std::string name = table.string(key, "");
    if (!name.empty() && message.find(name) == nullptr) {
      throw table.error(key, expectedOf(name, "a signal of message '" + message.name + "'", message.signals));
    }
  }
}

void checkCommandNames(const TomlTable& command, const can::Database& database) {
  const can::Message& message = messageAt(command, database);
  checkSignals(command, message, {"counter", "crc"});
  for (const char* part : {"output", "constant"}) {
    for (const TomlTable& table : command.tables(part)) {
      checkSignals(table, message, {"signal"});
    }
  }
  for (const char* frames : {"enter", "leave", "clear"}) {
    for (const TomlTable& table : command.tables(frames)) {
      if (table.has("message")) {
        messageAt(table, database);
      }
    }
  }
}

}  // namespace

void checkDbcNames(const TomlTable& root, const can::Database& database) {
  for (const TomlTable& table : root.tables("input")) {
    checkSignals(table, messageAt(table, database), {"signal"});
  }
  for (const TomlTable& table : root.tables("protection")) {
    checkSignals(table, messageAt(table, database), {"counter", "crc"});
  }
  if (root.isTable("command")) {
    checkCommandNames(root.table("command"), database);
  } else if (root.has("command")) {
    for (const TomlTable& table : root.tables("command")) {
      checkCommandNames(table, database);
    }
  }
}

}  // namespace patella::app
