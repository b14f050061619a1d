// A bus map is read against the shipped description or refused; of what is accepted, no signal feeds two
// inputs but those of status that say so, none carries two outputs, and nothing is bound to a counter or a
// CRC.
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/support/paths.hpp"

namespace {

using namespace patella;

void requireSingle(const app::BusDescription& bus) {
  std::map<std::pair<std::string, std::string>, std::vector<const can::Binding*>> read;
  for (const can::Binding& binding : bus.map.bindings) {
    fuzz::require(binding.message != bus.command.message, "no input reads the command");
    read[{binding.message, binding.signal}].push_back(&binding);
  }
  for (const auto& [signal, inputs] : read) {
    for (const can::Binding* input : inputs) {
      const bool status = input->input == "drive_enabled" || input->input == "drive_fault";
      fuzz::require(inputs.size() == 1 || (input->shared && status), "a signal feeds one input");
    }
  }
  std::set<std::string> protected_messages;
  for (const can::Protection& protection : bus.map.protections) {
    fuzz::require(protected_messages.insert(protection.message).second, "a message is protected once");
    fuzz::require(!read.contains({protection.message, protection.counter_signal}), "no input is a counter");
    fuzz::require(!read.contains({protection.message, protection.crc_signal}), "no input is a CRC");
  }
  std::set<std::string> written;
  for (const can::Binding& binding : bus.command.bindings) {
    fuzz::require(written.insert(binding.signal).second, "a signal carries one output");
    fuzz::require(binding.signal != bus.command.protection.counter_signal &&
                      binding.signal != bus.command.protection.crc_signal,
                  "no output is a counter or a CRC");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path dbc =
      std::filesystem::path(PATELLA_SOURCE_DIR) / "drivers/can/patella.dbc";
  try {
    const app::BusDescription bus =
        app::parseBusDescription(fuzz::expanded(fuzz::text(data, size)), "fuzz.toml", dbc);
    const can::MeasurementDecoder decoder(bus.database, bus.map, 2);
    const can::CommandEncoder encoder(bus.database, bus.command, 2);
    requireSingle(bus);
  } catch (const std::runtime_error&) {
    // refused with file and line
  } catch (const std::invalid_argument&) {
    // refused by a constructor
  }
  return 0;
}
