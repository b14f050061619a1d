#include "firmware_app/configuration/bus_map_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "drivers/can/binding_check.hpp"
#include "drivers/can/input_table.hpp"
#include "drivers/canopen/drive_binding.hpp"
#include "firmware_app/configuration/canopen_config.hpp"
#include "firmware_app/configuration/dbc_names.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

/// Ten times the highest speed that a joint may be allowed: what goes faster is no motion.
constexpr double kFastestJump_rad_s = 10.0 * boundOf("safety.velocity_rad_s").maximum;

struct BindingBounds {
  Bound scale;
  Bound offset;
};

constexpr BindingBounds kInput{boundOf("input.scale"), boundOf("input.offset")};
constexpr BindingBounds kOutput{boundOf("command.output.scale"), boundOf("command.output.offset")};

can::Binding readBinding(const TomlTable& table, const char* name, bool with_message,
                         const BindingBounds& bounds) {
  can::Binding binding;
  binding.input = table.string(name);
  binding.message = with_message ? table.string("message") : "";
  binding.signal = table.string("signal");
  binding.scale = number(table, bounds.scale, 1.0);
  binding.offset = number(table, bounds.offset, 0.0);
  binding.shared = table.boolean("shared", false);
  binding.scale_reason = table.string("scale_reason", "");
  binding.origin = table.origin();
  return binding;
}

can::Binding readInput(const TomlTable& table, BusAssignment& assignment) {
  constexpr CountRange kSomeValues{1, 32};
  can::Binding binding = readBinding(table, "name", true, kInput);
  if (table.has("good")) {
    binding.good = numbers(table, boundOf("input.good"), kSomeValues);
  }
  assignment.use(binding.message, assignment.read(table), binding.origin);
  return binding;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') {
    return c - '0';
  }
  const char low = static_cast<char>(c | 0x20);
  return low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
}

/// "FF 00 1c": bytes of two hexadecimal digits, with or without spaces between them.
std::vector<std::uint8_t> readBytes(const TomlTable& table, const char* key) {
  const std::string text = table.string(key, "");
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    const int high = hexDigit(text[i]);
    const int low = i + 1 < text.size() ? hexDigit(text[i + 1]) : -1;
    if (high < 0 || low < 0) {
      throw table.error(key,
                        "value '" + text + "', expected bytes of two hexadecimal digits each, as 'FF 0C'");
    }
    bytes.push_back(static_cast<std::uint8_t>(16 * high + low));
    i += 2;
  }
  return bytes;
}

std::vector<can::FixedFrame> readFrames(const TomlTable& table, const char* key) {
  constexpr std::size_t kMostFrames = 8;
  std::vector<can::FixedFrame> frames;
  for (const TomlTable& frame : table.tables(key)) {
    frames.push_back({frame.string("message", ""), readBytes(frame, "data"), frame.origin()});
  }
  if (frames.size() > kMostFrames) {
    throw table.error(key, std::to_string(frames.size()) + " frames, expected at most " +
                               std::to_string(kMostFrames) + ": they go out within one tick");
  }
  return frames;
}

can::CommandMap readCommand(const TomlTable& table, BusAssignment& assignment) {
  can::CommandMap command;
  command.message = table.string("message");
  command.origin = table.origin();
  command.protection = {.message = command.message,
                        .counter_signal = table.string("counter", ""),
                        .crc_signal = table.string("crc", ""),
                        .origin = command.origin};
  for (const TomlTable& output : table.tables("output")) {
    command.bindings.push_back(readBinding(output, "name", false, kOutput));
  }
  for (const TomlTable& constant : table.tables("constant")) {
    command.constants.push_back(
        {constant.string("signal"), number(constant, boundOf("command.constant.value")), constant.origin()});
  }
  command.enter = readFrames(table, "enter");
  command.leave = readFrames(table, "leave");
  command.clear = readFrames(table, "clear");
  command.enter_period_s = number(table, boundOf("command.enter_period_s"), command.enter_period_s);
  command.enter_timeout_s = number(table, boundOf("command.enter_timeout_s"), command.enter_timeout_s);
  if (table.has("enter_time_s")) {
    command.enter_time_s = number(table, boundOf("command.enter_time_s"));
  }
  const std::optional<std::uint8_t> bus = assignment.read(table);
  assignment.use(command.message, bus, command.origin);
  for (const auto* frames : {&command.enter, &command.leave, &command.clear}) {
    for (const can::FixedFrame& frame : *frames) {
      assignment.use(frame.message.empty() ? command.message : frame.message, bus, frame.origin);
    }
  }
  return command;
}

/// What a raw value of a signal means that a motor's maker spreads over a range: no bits set is the minimum,
/// all of them the maximum.
struct SignalRange {
  TomlTable table;
  std::string message;
  std::string signal;
  double minimum;
  double maximum;
};

SignalRange readRange(const TomlTable& table) {
  SignalRange range{table, table.string("message"), table.string("signal"),
                    number(table, boundOf("range.minimum")), number(table, boundOf("range.maximum"))};
  if (!(range.minimum < range.maximum)) {
    throw table.error("maximum", "value " + formatNumber(range.maximum) +
                                     ", expected more than minimum, which is " + formatNumber(range.minimum));
  }
  return range;
}

void applyRange(const SignalRange& range, can::Database& database) {
  const auto message =
      std::find_if(database.messages.begin(), database.messages.end(),
                   [&](const can::Message& candidate) { return candidate.name == range.message; });
  if (message == database.messages.end()) {
    throw range.table.error("message",
                            "value '" + range.message + "', expected a message of " + database.source);
  }
  const auto signal =
      std::find_if(message->signals.begin(), message->signals.end(),
                   [&](const can::Signal& candidate) { return candidate.name == range.signal; });
  constexpr int kMostBits = 32;
  if (signal == message->signals.end() || signal->type != can::ValueType::kInteger || signal->is_signed ||
      signal->length > kMostBits) {
    throw range.table.error("signal",
                            "value '" + range.signal + "', expected an unsigned signal of at most " +
                                std::to_string(kMostBits) + " bits of message '" + range.message + "'");
  }
  signal->factor =
      (range.maximum - range.minimum) / static_cast<double>((std::uint64_t{1} << signal->length) - 1);
  signal->offset = range.minimum;
  signal->minimum = range.minimum;
  signal->maximum = range.maximum;
}

can::Protection readProtection(const TomlTable& table) {
  return {.message = table.string("message"),
          .counter_signal = table.string("counter", ""),
          .crc_signal = table.string("crc", ""),
          .origin = table.origin()};
}

void requireAtLeast(const TomlTable& table, const char* key, double timeout_s, const char* period_key,
                    double period_s) {
  if (timeout_s < period_s) {
    throw table.error(key, "value " + formatNumber(timeout_s) + ", expected at least " + period_key +
                               ", which is " + formatNumber(period_s));
  }
}

void readTiming(const TomlTable& table, bool rehearsal, can::BusMap& map) {
  const auto timeout = [&](const Bound& bound, double& value) {
    value = number(table, bound, value, rehearsal);
  };
  timeout(boundOf("checks.encoder_timeout_s"), map.encoder_timeout_s);
  timeout(boundOf("checks.drive_timeout_s"), map.drive_timeout_s);
  timeout(boundOf("checks.emg_timeout_s"), map.emg_timeout_s);
  timeout(boundOf("checks.operator_timeout_s"), map.operator_timeout_s);
  map.encoder_period_s = number(table, boundOf("checks.encoder_period_s"), map.encoder_period_s);
  map.emg_period_s = number(table, boundOf("checks.emg_period_s"), map.emg_period_s);
  requireAtLeast(table, "encoder_timeout_s", map.encoder_timeout_s, "encoder_period_s", map.encoder_period_s);
  requireAtLeast(table, "emg_timeout_s", map.emg_timeout_s, "emg_period_s", map.emg_period_s);
  readInteger(table, boundOf("checks.tolerated_bad_frames"), map.tolerated_bad_frames, rehearsal);
}

void readPositions(const TomlTable& table, can::BusMap& map) {
  map.position_min_rad = number(table, boundOf("checks.position_min_rad"), map.position_min_rad);
  map.position_max_rad = number(table, boundOf("checks.position_max_rad"), map.position_max_rad);
  if (!(map.position_min_rad < map.position_max_rad)) {
    throw table.error("position_min_rad", "value " + formatNumber(map.position_min_rad) +
                                              ", expected less than position_max_rad, which is " +
                                              formatNumber(map.position_max_rad));
  }
  const double fastest_rad = kFastestJump_rad_s * map.encoder_period_s;
  map.position_jump_rad =
      number(table, boundOf("checks.position_jump_rad"), std::min(map.position_jump_rad, fastest_rad));
  if (map.position_jump_rad > fastest_rad) {
    throw table.error("position_jump_rad", "value " + formatNumber(map.position_jump_rad) +
                                               ", expected at most " + formatNumber(fastest_rad) + ", " +
                                               formatNumber(kFastestJump_rad_s) +
                                               " rad/s over encoder_period_s");
  }
}

// A node's bus is that of its PDOs, which other tables may bind as well.
void assignNodes(const BusDescription& bus, const std::vector<std::optional<std::uint8_t>>& buses,
                 BusAssignment& assignment) {
  for (std::size_t i = 0; i < bus.canopen.drives.size(); ++i) {
    const canopen::DriveSettings& drive = bus.canopen.drives[i];
    for (const std::uint32_t id : {canopen::reportId(drive.node), canopen::commandId(drive.node)}) {
      assignment.use(bus.database.find(id, false)->name, buses[i], drive.origin);
    }
  }
}

void placeNodes(BusDescription& bus) {
  for (canopen::DriveSettings& drive : bus.canopen.drives) {
    drive.bus = bus.database.find(canopen::commandId(drive.node), false)->bus;
  }
}

}  // namespace

std::string fdMessage(const BusDescription& bus, std::size_t number) {
  std::vector<std::string> names;
  for (const can::CommandMap& command : bus.commands) {
    names.push_back(command.message);
    for (const auto* frames : {&command.enter, &command.leave, &command.clear}) {
      for (const can::FixedFrame& frame : *frames) {
        names.push_back(frame.message.empty() ? command.message : frame.message);
      }
    }
  }
  for (const can::Binding& binding : bus.map.bindings) {
    // The truth comes from simulated rigs alone.
    if (can::inputOf(binding.input, kMaxJoints).input != can::Input::kTruth) {
      names.push_back(binding.message);
    }
  }
  for (const std::string& name : names) {
    const can::Message& message = bus.database.message(name);
    if (message.fd && message.bus == number) {
      return name;
    }
  }
  return "";
}

BusDescription loadBusDescription(const std::filesystem::path& path,
                                  const std::optional<std::filesystem::path>& dbc, bool rehearsal,
                                  const BusNames& buses) {
  return parseBusDescription(readFile(path), path.string(), dbc, rehearsal, buses);
}

BusDescription parseBusDescription(std::string_view text, const std::string& name,
                                   const std::optional<std::filesystem::path>& dbc, bool rehearsal,
                                   const BusNames& buses) {
  const TomlDocument document = TomlDocument::parse(text, name);
  const TomlTable& root = document.root();
  BusAssignment assignment(buses);
  BusDescription bus;
  if (dbc) {
    root.string("dbc");  // a recording holds both files, and not where they were
    bus.dbc_path = *dbc;
  } else {
    bus.dbc_path = root.existing("dbc");
  }
  const TomlTable checks = root.optionalTable("checks");
  readTiming(checks, rehearsal, bus.map);
  readPositions(checks, bus.map);
  for (const TomlTable& table : root.tables("input")) {
    bus.map.bindings.push_back(readInput(table, assignment));
  }
  for (const TomlTable& table : root.tables("protection")) {
    bus.map.protections.push_back(readProtection(table));
  }
  const auto node_buses = readCanopen(root, rehearsal, assignment, bus);
  const bool own_commands = root.has("command") || !bus.canopen.any();
  if (own_commands && (!root.has("command") || root.isTable("command"))) {
    bus.commands.push_back(readCommand(root.table("command"), assignment));
  } else {
    for (const TomlTable& table : root.tables("command")) {
      bus.commands.push_back(readCommand(table, assignment));
    }
  }
  std::vector<SignalRange> ranges;
  for (const TomlTable& table : root.tables("range")) {
    ranges.push_back(readRange(table));
  }
  document.finish();
  bus.database = can::loadDbc(bus.dbc_path);
  checkDbcNames(root, bus.database);
  for (const SignalRange& range : ranges) {
    applyRange(range, bus.database);
  }
  try {
    canopen::bindDrives(bus.canopen, bus.database, bus.map, bus.commands);
    assignNodes(bus, node_buses, assignment);
    assignment.apply(name, bus.database);
    placeNodes(bus);
    can::checkBindings(bus.database, bus.map, bus.commands);
  } catch (const std::invalid_argument& error) {
    throw FileError(error.what());
  }
  return bus;
}

}  // namespace patella::app
