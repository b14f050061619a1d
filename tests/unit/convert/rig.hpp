// The project's bus, and small recordings for it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/dbc.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {

inline can::Database rigBus() {
  return can::loadDbc(checkout::source() / "drivers/can/patella.dbc");
}

inline std::string shippedMap(const std::string& name) {
  return checkout::source() / "tools/convert/maps" / (name + ".toml");
}

inline std::vector<can::Frame> framesOf(const std::filesystem::path& log) {
  std::vector<can::Frame> frames;
  can::CandumpReader reader(log);
  can::LogEntry entry;
  while (reader.next(entry)) {
    frames.push_back(entry.frame);
  }
  return frames;
}

}  // namespace patella::test
