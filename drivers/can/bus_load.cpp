#include "drivers/can/bus_load.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "core/types.hpp"
#include "drivers/can/input_table.hpp"
#include "drivers/can/message_codec.hpp"

namespace patella::can {
namespace {

int mostBitsFd(int data_bits, bool extended) noexcept {
  // Start, identifier and control field up to the length code.
  const int header = extended ? 41 : 22;
  const int stuffable = header + data_bits;
  constexpr int kShortCrcData = 128;
  // Stuff count of 4 bits and a CRC of 17 or 21, with a fixed stuff bit before and after every four.
  const int check = data_bits <= kShortCrcData ? 4 + 17 + 6 : 4 + 21 + 7;
  constexpr int kTail = 1 + 1 + 1 + 7 + 3;  // delimiter, acknowledge and its delimiter, end, pause
  return stuffable + (stuffable - 1) / 4 + check + kTail;
}

/// Readings of a message: how often it comes, and with which selections.
struct Reading {
  double rate_Hz = 0.0;
  std::set<std::pair<std::string, std::uint64_t>> selections;
};

double rateOf(const Message& message, const Binding& binding, const BusMap& map, double loop_rate_Hz) {
  const Input input = inputOf(binding.input, kMaxJoints).input;
  if (input == Input::kPosition)
    return 1.0 / map.encoder_period_s;
  if (input == Input::kEmg)
    return 1.0 / map.emg_period_s;
  const double cycle_s = message.cycle_time_s.value_or(0.0);
  return cycle_s > 0.0 ? 1.0 / cycle_s : loop_rate_Hz;
}

}  // namespace

int mostBits(int bytes, bool extended, bool fd) noexcept {
  const int data_bits = 8 * bytes;
  if (fd)
    return mostBitsFd(data_bits, extended);
  const int stuffable = (extended ? 54 : 34) + data_bits;
  return stuffable + 13 + (stuffable - 1) / 4;
}

BusLoad busLoad(const Database& database, const BusMap& map, std::span<const CommandMap> commands,
                double rate_Hz, std::size_t bus) {
  BusLoad load;
  const auto add = [&load, bus](const Message& message, double frames_per_s) {
    if (message.bus != bus)
      return;
    load.frames_per_s += frames_per_s;
    load.bits_per_s += frames_per_s * mostBits(fdLength(message.length), message.extended, message.fd);
  };
  for (const CommandMap& command : commands) {
    add(database.message(command.message), rate_Hz);
    const auto& longer = command.enter.size() > command.leave.size() ? command.enter : command.leave;
    for (const FixedFrame& frame : longer)
      add(database.message(frame.message.empty() ? command.message : frame.message),
          1.0 / command.enter_period_s);
  }
  std::map<std::string, Reading> readings;
  for (const Binding& binding : map.bindings) {
    const Message& message = database.message(binding.message);
    const Input input = inputOf(binding.input, kMaxJoints).input;
    if (input == Input::kTruth)
      continue;
    const bool sensor = input == Input::kPosition || input == Input::kEmg;
    Reading& reading = readings[binding.message];
    // What is told beside a sample comes as often as the sample.
    const double own_Hz = rateOf(message, binding, map, rate_Hz);
    reading.rate_Hz = sensor || reading.rate_Hz == 0.0 ? own_Hz : reading.rate_Hz;
    const Signal* signal = message.find(binding.signal);
    if (signal != nullptr && !signal->multiplex_ranges.empty())
      reading.selections.insert({signal->multiplexor, signal->multiplex_ranges.front().first});
  }
  for (const auto& [name, reading] : readings) {
    add(database.message(name),
        reading.rate_Hz * static_cast<double>(std::max<std::size_t>(reading.selections.size(), 1)));
  }
  return load;
}

}  // namespace patella::can
