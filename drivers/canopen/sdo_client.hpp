// Reads and writes entries of a node's object dictionary by SDO (CiA 301), blocking: before the first tick
// only.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/bus.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/canopen/canopen_map.hpp"
#include "drivers/clock/clock.hpp"

namespace patella::canopen {

/// what() reads `node 1: 6076h:0: problem`.
class NodeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The node refused: it ended the transfer with a code.
class SdoAbort : public NodeError {
 public:
  SdoAbort(const std::string& where, std::uint32_t code);
  std::uint32_t code() const noexcept { return code_; }
  /// The entry is not there at all.
  bool absent() const noexcept;

 private:
  std::uint32_t code_;
};

/// Meaning of an abort code after CiA 301; "unknown code" for one that it has not.
std::string_view abortText(std::uint32_t code) noexcept;

/// "6076h" or, beyond the first entry, "1018h:2".
std::string objectName(std::uint16_t index, std::uint8_t sub);

/// An answer is waited for 0.5 s, and the request sent three times at most.
class SdoClient {
 public:
  /// Both must outlive the client.
  SdoClient(can::Bus& bus, Clock& clock, int node) : bus_(bus), clock_(clock), node_(node) {}

  /// All throw NodeError where no answer comes or one that is none, SdoAbort where the node refuses.
  /// An answer of any size, expedited or in segments, up to 256 bytes.
  std::vector<std::uint8_t> read(std::uint16_t index, std::uint8_t sub = 0);
  /// Little-endian number of 1, 2 or 4 bytes. Servers may answer with more bytes than the entry has: these
  /// are left out.
  std::uint32_t number(std::uint16_t index, std::uint8_t sub, int bytes);
  void write(const ObjectValue& object);

  int node() const noexcept { return node_; }
  [[noreturn]] void fail(std::uint16_t index, std::uint8_t sub, const std::string& problem) const;

 private:
  /// What an answer has to be: command specifier under a mask, and the entry where it names one.
  struct Expected {
    unsigned mask;
    unsigned value;
    bool names_entry;
  };
  can::Frame ask(const can::Frame& request, std::uint16_t index, std::uint8_t sub, const Expected& expected,
                 int tries);
  can::Frame request(unsigned command, std::uint16_t index, std::uint8_t sub) const noexcept;
  std::vector<std::uint8_t> readSegments(std::uint16_t index, std::uint8_t sub);
  void abort(std::uint16_t index, std::uint8_t sub) noexcept;
  std::string where(std::uint16_t index, std::uint8_t sub) const;

  can::Bus& bus_;
  Clock& clock_;
  int node_;
};

}  // namespace patella::canopen
