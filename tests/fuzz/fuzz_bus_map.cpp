// A bus map is read against the shipped description or refused; of what is accepted, no signal feeds two
// inputs but those of status that say so, none carries two outputs, and nothing is bound to a counter or a
// CRC.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tools/checkout/checkout.hpp"

namespace {

using namespace patella;

void requireSingle(const app::BusDescription& bus) {
  std::map<std::pair<std::string, std::string>, std::vector<const can::Binding*>> read;
  for (const can::Binding& binding : bus.map.bindings) {
    for (const can::CommandMap& command : bus.commands) {
      fuzz::require(binding.message != command.message, "no input reads a command");
    }
    read[{binding.message, binding.signal}].push_back(&binding);
  }
  for (const auto& [signal, inputs] : read) {
    for (const can::Binding* input : inputs) {
      const bool status = input->input.starts_with("drive_enabled") ||
                          input->input.starts_with("drive_fault") || input->input.starts_with("drive_error");
      fuzz::require(inputs.size() == 1 || (input->shared && status), "a signal feeds one input");
    }
  }
  std::set<std::string> protected_messages;
  for (const can::Protection& protection : bus.map.protections) {
    fuzz::require(protected_messages.insert(protection.message).second, "a message is protected once");
    fuzz::require(!read.contains({protection.message, protection.counter_signal}), "no input is a counter");
    fuzz::require(!read.contains({protection.message, protection.crc_signal}), "no input is a CRC");
  }
  std::set<std::string> moved;
  for (const can::CommandMap& command : bus.commands) {
    std::set<std::string> written;
    for (const can::Binding& binding : command.bindings) {
      fuzz::require(written.insert(binding.signal).second, "a signal carries one output");
      fuzz::require(!binding.input.starts_with("torque_Nm") || moved.insert(binding.input).second,
                    "a joint has one drive");
      fuzz::require(binding.signal != command.protection.counter_signal &&
                        binding.signal != command.protection.crc_signal,
                    "no output is a counter or a CRC");
    }
  }
}

/// What a command does not set is zero on the bus, in the unit of the signal.
void requireZero(const app::BusDescription& bus, const can::CommandEncoder& encoder) {
  for (std::size_t i = 0; i < encoder.size(); ++i) {
    const can::Frame frame = encoder.drive(i).encode({JointVector::Zero(2), false, 0});
    for (const can::Signal& signal : bus.database.message(bus.commands[i].message).signals) {
      const auto is_constant = [&](const can::Constant& c) { return c.signal == signal.name; };
      const auto is_output = [&](const can::Binding& b) { return b.signal == signal.name; };
      const auto& constants = bus.commands[i].constants;
      const auto& outputs = bus.commands[i].bindings;
      const can::Protection& protection = bus.commands[i].protection;
      const bool guards = signal.name == protection.counter_signal || signal.name == protection.crc_signal;
      if (!guards && std::none_of(constants.begin(), constants.end(), is_constant) &&
          std::none_of(outputs.begin(), outputs.end(), is_output)) {
        const can::CompiledSignal compiled(bus.database.message(bus.commands[i].message), signal);
        const double value = compiled.decode(frame);
        fuzz::require(!(std::abs(value) > 0.0), "what nobody sets is zero");
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path dbc = checkout::source() / "drivers/can/patella.dbc";
  try {
    const app::BusDescription bus =
        app::parseBusDescription(fuzz::expanded(fuzz::text(data, size)), "fuzz.toml", dbc);
    const can::MeasurementDecoder decoder(bus.database, bus.map, 2);
    const can::CommandEncoder encoder(bus.database, bus.commands, 2);
    requireSingle(bus);
    requireZero(bus, encoder);
  } catch (const std::runtime_error&) {
    // refused with file and line
  } catch (const std::invalid_argument&) {
    // refused by a constructor
  }
  return 0;
}
