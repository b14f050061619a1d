// A line of a log is read or refused; what is read is written as the same frame again, to the microsecond.
#include <array>
#include <stdexcept>

#include "drivers/can/candump_log.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace patella;
  can::LogEntry entry;
  try {
    can::parseLogLine(fuzz::text(data, size), entry);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  std::array<char, can::kMaxLogLine> line{};
  const std::size_t length = can::formatLogLine(line, entry);
  fuzz::require(length > 1 && line[length - 1] == '\n', "what was read can be written");
  can::LogEntry again;
  can::parseLogLine({line.data(), length - 1}, again);
  const auto stamp_us = [](const can::LogEntry& of) { return of.frame.wall_ns / 1000; };
  fuzz::require(again.frame.id == entry.frame.id && again.frame.length == entry.frame.length &&
                    again.frame.data == entry.frame.data && stamp_us(again) == stamp_us(entry) &&
                    again.interface == entry.interface && again.fd_flags == entry.fd_flags &&
                    again.direction == entry.direction,
                "what was written is what was read");
  return 0;
}
