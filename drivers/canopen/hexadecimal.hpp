// Numbers as CANopen's documents write them: 6076h.
#pragma once

#include <cstdint>
#include <string>

namespace patella::canopen {

inline std::string hexadecimal(std::uint32_t value, int digits) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (int digit = digits - 1; digit >= 0; --digit) {
    text += kDigits[value >> (4 * digit) & 0xFU];
  }
  return text + "h";
}

}  // namespace patella::canopen
