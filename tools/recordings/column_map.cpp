#include "tools/recordings/column_map.hpp"

#include <algorithm>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::diagnose {
namespace {

using app::TomlTable;

ColumnSource readSource(const TomlTable& table, bool may_be_constant) {
  ColumnSource source;
  if (may_be_constant && table.has("constant")) {
    if (table.has("column")) {
      throw table.error("constant", "stands beside 'column', expected one of the two");
    }
    source.offset = table.number("constant");
    return source;
  }
  source.column = table.string("column");
  source.scale = table.number("scale", app::kAnyNumber, 1.0);
  if (source.scale == 0.0) {
    throw table.error("scale", "value 0, expected a number other than 0");
  }
  source.offset = table.number("offset", app::kAnyNumber, 0.0);
  return source;
}

// At rest a joint may be without a torque: where it stands is all that is known of it.
JointColumns readJoint(const TomlTable& table, bool at_rest) {
  JointColumns joint{.position_rad = readSource(table.table("position"), true),
                     .torque_Nm = {},
                     .commanded_Nm = std::nullopt};
  const TomlTable torque = table.optionalTable("torque");
  if (torque.present()) {
    joint.torque_Nm = readSource(torque, true);
  } else if (!at_rest) {
    throw table.error("torque", "is missing, expected a table with a column");
  }
  const TomlTable commanded = table.optionalTable("commanded");
  if (commanded.present()) {
    joint.commanded_Nm = readSource(commanded, false);
  }
  return joint;
}

std::vector<ColumnSource> readChannels(const TomlTable& root, const char* key) {
  std::vector<ColumnSource> channels;
  for (const TomlTable& table : root.tables(key)) {
    channels.push_back(readSource(table, false));
  }
  if (channels.size() > kMaxEmgChannels) {
    throw root.error(key, std::to_string(channels.size()) + " channels, expected at most " +
                              std::to_string(kMaxEmgChannels));
  }
  return channels;
}

void readTime(const TomlTable& recording, ColumnMap& map) {
  map.is_static = recording.boolean("static", false);
  if (map.is_static) {
    if (recording.has("time_column")) {
      throw recording.error("time_column", "stands beside static = true, expected one of the two");
    }
    return;
  }
  map.time_column = recording.string("time_column");
  map.time_scale_s = recording.number("time_scale_s", app::kPositive, 1.0);
  map.torque_timing = recording.choice("torque", std::vector<std::string>{"held", "sampled"}) == "held"
                          ? TorqueTiming::kHeld
                          : TorqueTiming::kSampled;
}

}  // namespace

std::vector<std::string> ColumnMap::columns() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  };
  add(time_column);
  for (const JointColumns& joint : joints) {
    add(joint.position_rad.column);
    add(joint.torque_Nm.column);
    if (joint.commanded_Nm) {
      add(joint.commanded_Nm->column);
    }
  }
  for (const auto* channels : {&emg_mV, &activation}) {
    for (const ColumnSource& channel : *channels) {
      add(channel.column);
    }
  }
  for (const RowChoice& choice : only) {
    add(choice.column);
  }
  return names;
}

ColumnMap loadColumnMap(const std::filesystem::path& path) {
  return parseColumnMap(app::readFile(path), path.string());
}

ColumnMap parseColumnMap(std::string_view text, const std::string& name) {
  const app::TomlDocument document = app::TomlDocument::parse(text, name);
  const TomlTable& root = document.root();
  ColumnMap map;
  const TomlTable recording = root.table("recording");
  const std::string delimiter =
      recording.choice("delimiter", std::vector<std::string>{"comma", "semicolon", "tab"}, "comma");
  map.delimiter = delimiter == "comma" ? ',' : delimiter == "semicolon" ? ';' : '\t';
  readTime(recording, map);
  for (const TomlTable& table : root.tables("joint")) {
    map.joints.push_back(readJoint(table, map.is_static));
  }
  if (map.joints.empty() || map.joints.size() > kMaxJoints) {
    throw root.error("joint", std::to_string(map.joints.size()) +
                                  " tables [[joint]], expected one for each joint, 1 to " +
                                  std::to_string(kMaxJoints));
  }
  map.emg_mV = readChannels(root, "emg");
  map.activation = readChannels(root, "activation");
  if (!map.emg_mV.empty() && !map.activation.empty()) {
    throw root.error("activation", "stands beside [[emg]], expected one of the two");
  }
  for (const TomlTable& table : root.tables("only")) {
    map.only.push_back({.column = table.string("column"), .equals = table.number("equals")});
  }
  document.finish();
  return map;
}

}  // namespace patella::diagnose
