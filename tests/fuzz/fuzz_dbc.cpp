// A bus description is read or refused; what is read can be compiled, encoded and decoded.
#include <stdexcept>

#include "drivers/can/dbc.hpp"
#include "drivers/can/message_codec.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace patella;
  try {
    const can::Database database = can::parseDbc(fuzz::text(data, size), "fuzz.dbc");
    for (const can::Message& message : database.messages) {
      try {
        can::MessageEncoder encoder(message);
        can::MessageDecoder decoder(message);
        for (const can::Signal& signal : message.signals) {
          can::Frame frame = encoder.blank();
          encoder.set(frame, encoder.slot(signal.name), 1.0);
          decoder.value(frame, decoder.slot(signal.name));
        }
      } catch (const std::invalid_argument&) {
        // a message that no frame can carry
      }
    }
  } catch (const std::runtime_error&) {
    // refused, with a line
  }
  return 0;
}
