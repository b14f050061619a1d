#include "tools/convert/conversion_map.hpp"

#include <algorithm>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::convert {
namespace {

using app::CountRange;
using app::TomlTable;

template <typename Named>
std::vector<std::string> namesOf(const std::vector<Named>& items) {
  std::vector<std::string> names;
  for (const Named& item : items) {
    names.push_back(item.name);
  }
  return names;
}

SignalSource readSignal(const TomlTable& table, const can::Message& message) {
  SignalSource source;
  source.signal = table.choice("signal", namesOf(message.signals));
  const int forms = table.has("constant") + table.has("column") + table.has("columns");
  if (forms != 1) {
    throw table.error("signal",
                      "'" + source.signal + "' needs exactly one of 'constant', 'column', 'columns'");
  }
  source.clip = table.boolean("clip", false);
  if (table.has("constant")) {
    source.offset = table.number("constant");
    return source;
  }
  if (table.has("column")) {
    source.columns = {table.string("column")};
    source.scales = {table.number("scale", app::kAnyNumber, 1.0)};
  } else {
    source.columns = table.strings("columns", {.minimum = 1});
    source.scales = table.numbers("scales", CountRange::exactly(source.columns.size()));
  }
  source.offset = table.number("offset", app::kAnyNumber, 0.0);
  const auto& names = interpolationNames();
  const std::string method = table.choice("interpolation", names, "linear");
  source.interpolation =
      static_cast<Interpolation>(std::find(names.begin(), names.end(), method) - names.begin());
  return source;
}

MessageSource readMessage(const TomlTable& table, const can::Database& database) {
  MessageSource source;
  source.message = table.string("message");
  const can::Message* message = database.find(source.message);
  if (message == nullptr) {
    throw table.error("message", "value '" + source.message + "', expected a message of " + database.source +
                                     app::suggestion(source.message, namesOf(database.messages)));
  }
  for (const TomlTable& signal : table.tables("signal")) {
    source.signals.push_back(readSignal(signal, *message));
    const auto same = [&](const SignalSource& other) { return other.signal == source.signals.back().signal; };
    if (std::count_if(source.signals.begin(), source.signals.end(), same) > 1) {
      throw signal.error("signal", "'" + source.signals.back().signal + "' already has a source");
    }
  }
  if (source.signals.empty()) {
    throw table.error("message", "'" + source.message + "' has no [[frame.signal]], expected at least one");
  }
  return source;
}

}  // namespace

std::vector<std::string> ConversionMap::columns() const {
  std::vector<std::string> names{time_column};
  for (const MessageSource& message : messages) {
    for (const SignalSource& signal : message.signals) {
      for (const std::string& column : signal.columns) {
        if (std::find(names.begin(), names.end(), column) == names.end()) {
          names.push_back(column);
        }
      }
    }
  }
  return names;
}

ConversionMap loadMap(const std::filesystem::path& path, const can::Database& database) {
  return parseMap(app::readFile(path), path.string(), database);
}

ConversionMap parseMap(std::string_view text, const std::string& name, const can::Database& database) {
  const app::TomlDocument document = app::TomlDocument::parse(text, name);
  ConversionMap map;
  const TomlTable recording = document.root().table("recording");
  map.time_column = recording.string("time_column");
  map.time_scale_s = recording.number("time_scale_s", app::kPositive, 1.0);
  if (recording.has("rate_Hz")) {
    map.rate_Hz = recording.number("rate_Hz", {.minimum = 1.0, .maximum = 20000.0});
  }
  const std::vector<std::string> delimiters{"comma", "semicolon", "tab"};
  const std::string delimiter = recording.choice("delimiter", delimiters, "comma");
  map.delimiter = delimiter == "comma" ? ',' : delimiter == "semicolon" ? ';' : '\t';

  const TomlTable log = document.root().optionalTable("log");
  map.channel = log.string("channel", "can0");
  map.start_wall_s = log.number("start_wall_s", {.minimum = 0.0, .maximum = 4e9}, 0.0);

  for (const TomlTable& frame : document.root().tables("frame")) {
    map.messages.push_back(readMessage(frame, database));
  }
  if (map.messages.empty()) {
    throw document.root().error("frame", "is missing, expected at least one [[frame]] table");
  }
  document.finish();
  return map;
}

}  // namespace patella::convert
