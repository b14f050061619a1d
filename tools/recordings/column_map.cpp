#include "tools/recordings/column_map.hpp"

#include <algorithm>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::diagnose {
namespace {

using app::TomlTable;

double readStart(const TomlTable& table) {
  const double unit = readUnit(table, Quantity::kPosition);
  return unit * table.number("constant");
}

/// Where the joint is: its position, or its velocity and where it starts from.
void readMotion(const TomlTable& table, const ColumnMap& map, JointColumns& joint) {
  const TomlTable velocity = table.optionalTable("velocity");
  if (velocity.present()) {
    if (map.is_static) {
      throw table.error("velocity", "stands beside static = true, expected a position only");
    }
    joint.velocity_rad_s = readSignal(velocity, Quantity::kVelocity, map.naming);
  }
  const TomlTable start = table.optionalTable("start");
  if (!velocity.present() || table.has("position")) {
    joint.position_rad = readSignalOrConstant(table.table("position"), Quantity::kPosition, map.naming);
    if (start.present()) {
      throw table.error("start",
                        "is only where a velocity is integrated, expected it beside 'velocity' "
                        "without 'position'");
    }
    return;
  }
  if (!start.present()) {
    throw table.error("start",
                      "is missing, expected a table with 'constant': the position at which the "
                      "integral of 'velocity' begins, or 'position' in its place");
  }
  joint.start_rad = readStart(start);
}

// At rest a joint may be without a torque: where it stands is all that is known of it.
JointColumns readJoint(const TomlTable& table, const ColumnMap& map) {
  JointColumns joint;
  readMotion(table, map, joint);
  const TomlTable torque = table.optionalTable("torque");
  if (torque.present()) {
    joint.torque_Nm = readSignalOrConstant(torque, Quantity::kTorque, map.naming);
  } else if (!map.is_static) {
    throw table.error("torque", "is missing, expected a table with a column");
  }
  const TomlTable commanded = table.optionalTable("commanded");
  if (commanded.present()) {
    joint.commanded_Nm = readSignal(commanded, Quantity::kTorque, map.naming);
  }
  return joint;
}

std::vector<SignalSource> readChannels(const TomlTable& root, const char* key, Quantity quantity,
                                       ColumnNaming naming) {
  std::vector<SignalSource> channels;
  for (const TomlTable& table : root.tables(key)) {
    channels.push_back(readSignal(table, quantity, naming));
  }
  if (channels.size() > kMaxEmgChannels) {
    throw root.error(key, std::to_string(channels.size()) + " channels, expected at most " +
                              std::to_string(kMaxEmgChannels) +
                              ": choose the muscles that move the joints of the model, or add the "
                              "activations of one group of muscles by 'sum'");
  }
  return channels;
}

void readTimeColumn(const TomlTable& recording, ColumnMap& map) {
  try {
    map.time_column = readColumn(recording, map.naming, "time_");
  } catch (const app::FileError& error) {
    throw recording.has("time_column")
        ? error
        : app::FileError(std::string(error.what()) + ", or 'rate_Hz' for a file without times");
  }
  if (recording.has("time_unit") && recording.has("time_scale_s")) {
    throw recording.error("time_unit", "stands beside 'time_scale_s', expected one of the two");
  }
  map.time_scale_s = readUnit(recording, Quantity::kTime, "time_unit") *
                     recording.number("time_scale_s", app::kPositive, 1.0);
}

void readTime(const TomlTable& recording, ColumnMap& map) {
  map.is_static = recording.boolean("static", false);
  for (const char* key : {"time_column", "rate_Hz"}) {
    if (map.is_static && recording.has(key)) {
      throw recording.error(key, "stands beside static = true, expected one of the two");
    }
  }
  if (map.is_static) {
    return;
  }
  if (!recording.has("rate_Hz")) {
    readTimeColumn(recording, map);
  } else if (recording.has("time_column")) {
    throw recording.error("rate_Hz", "stands beside 'time_column', expected one of the two");
  } else {
    constexpr app::Range kRates{.minimum = 2.0, .maximum = 5e4};  // those of stamps, see time_units
    map.rate_Hz = recording.number("rate_Hz", kRates);
  }
  map.torque_timing = torqueTimingNamed(recording.choice("torque", torqueTimingNames()));
}

void readForm(const TomlTable& recording, ColumnMap& map) {
  const std::string delimiter =
      recording.choice("delimiter", std::vector<std::string>{"comma", "semicolon", "tab", "space"}, "comma");
  map.delimiter = delimiter == "comma"       ? ','
                  : delimiter == "semicolon" ? ';'
                  : delimiter == "tab"       ? '\t'
                                             : ' ';
  map.naming = recording.boolean("header", true) ? ColumnNaming::kNames : ColumnNaming::kNumbers;
}

}  // namespace

std::vector<FileColumn> ColumnMap::columns() const {
  std::vector<FileColumn> all;
  const auto add = [&](const FileColumn& column) {
    if (std::find(all.begin(), all.end(), column) == all.end()) {
      all.push_back(column);
    }
  };
  const auto add_signal = [&](const SignalSource& source) {
    for (const SignalTerm& term : source.terms) {
      add(term.column);
    }
  };
  if (time_column) {
    add(*time_column);
  }
  for (const JointColumns& joint : joints) {
    for (const auto* source : {&joint.position_rad, &joint.velocity_rad_s, &joint.commanded_Nm}) {
      if (*source) {
        add_signal(**source);
      }
    }
    add_signal(joint.torque_Nm);
  }
  for (const auto* channels : {&emg_mV, &activation}) {
    std::for_each(channels->begin(), channels->end(), add_signal);
  }
  for (const RowChoice& choice : only) {
    add(choice.column);
  }
  return all;
}

ColumnMap loadColumnMap(const std::filesystem::path& path) {
  return parseColumnMap(app::readFile(path), path.string());
}

ColumnMap parseColumnMap(std::string_view text, const std::string& name) {
  const app::TomlDocument document = app::TomlDocument::parse(text, name);
  const TomlTable& root = document.root();
  ColumnMap map;
  const TomlTable recording = root.table("recording");
  readForm(recording, map);
  readTime(recording, map);
  for (const TomlTable& table : root.tables("joint")) {
    map.joints.push_back(readJoint(table, map));
  }
  if (map.joints.empty() || map.joints.size() > kMaxJoints) {
    throw root.error("joint", std::to_string(map.joints.size()) +
                                  " tables [[joint]], expected one for each joint, 1 to " +
                                  std::to_string(kMaxJoints));
  }
  map.emg_mV = readChannels(root, "emg", Quantity::kEmg, map.naming);
  map.activation = readChannels(root, "activation", Quantity::kActivation, map.naming);
  if (!map.emg_mV.empty() && !map.activation.empty()) {
    throw root.error("activation", "stands beside [[emg]], expected one of the two");
  }
  for (const TomlTable& table : root.tables("only")) {
    map.only.push_back({.column = readColumn(table, map.naming), .equals = table.number("equals")});
  }
  document.finish();
  if (map.columns().empty()) {
    throw root.error("joint", "names no column, expected at least one");
  }
  return map;
}

}  // namespace patella::diagnose
