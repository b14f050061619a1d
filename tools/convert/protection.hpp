// Which signals of a message guard it, where no configuration says so.
#pragma once

#include "drivers/can/message_codec.hpp"

namespace patella::convert {

/// Signals named Counter and Crc, as far as the message has them.
inline can::Protection usualProtection(const can::Message& message) {
  const auto if_present = [&](const char* name) {
    return message.find(name) != nullptr ? std::string(name) : std::string();
  };
  return {.message = message.name, .counter_signal = if_present("Counter"), .crc_signal = if_present("Crc")};
}

}  // namespace patella::convert
