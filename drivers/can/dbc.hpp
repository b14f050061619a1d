// Bus descriptions in Vector's DBC format: which identifier carries which signal, where, and in what unit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace patella::can {

enum class ByteOrder : std::uint8_t { kIntel, kMotorola };
enum class ValueType : std::uint8_t { kInteger, kFloat32, kFloat64 };

/// Inclusive range of a multiplexor's raw bits.
struct MultiplexRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

struct Signal {
  std::string name;
  int start_bit = 0;  ///< as the file numbers it: least significant bit (Intel), most significant (Motorola)
  int length = 0;     ///< bits
  ByteOrder byte_order = ByteOrder::kIntel;
  ValueType type = ValueType::kInteger;
  bool is_signed = false;
  double factor = 1.0;
  double offset = 0.0;
  double minimum = 0.0;  ///< physical; minimum == maximum == 0 means that no range is declared
  double maximum = 0.0;
  std::string unit;
  std::vector<std::string> receivers;
  bool is_multiplexor = false;
  std::string multiplexor;  ///< name of the signal that selects this one; empty where it is always present
  std::vector<MultiplexRange> multiplex_ranges;
  std::map<std::int64_t, std::string> value_names;
  std::string comment;
};

struct Message {
  std::uint32_t id = 0;  ///< 11 or 29 bits, without the flag of bit 31
  bool extended = false;
  std::string name;
  int length = 0;  ///< bytes; above 64 (J1939 transport) it cannot be one frame and cannot be bound
  bool fd = false;
  bool bit_rate_switch = false;
  std::optional<double> cycle_time_s;  ///< GenMsgCycleTime
  std::vector<std::string> senders;
  std::vector<Signal> signals;
  std::string comment;
  std::uint8_t bus = 0;  ///< on which of the loop's buses it travels; not of the DBC

  const Signal* find(std::string_view signal) const noexcept;
};

struct Database {
  std::string source;  ///< file name, for messages
  std::string version;
  std::string comment;
  std::vector<std::string> nodes;
  std::vector<Message> messages;

  const Message* find(std::string_view message) const noexcept;
  const Message* find(std::uint32_t id, bool extended) const noexcept;

  /// As find(), but throws std::invalid_argument naming the file and the messages there are.
  const Message& message(std::string_view name) const;
};

/// what() reads `file:line:column: message`.
class DbcError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a description. Text that is not UTF-8 is taken as Windows-1252, which editors of the format write.
/// Sections that say nothing about decoding are checked for form and skipped. Throws DbcError where the
/// text is malformed, a signal leaves its message, signals overlap without excluding each other by a
/// multiplexor, an identifier is too wide, or a name or identifier occurs twice.
Database parseDbc(std::string_view text, std::string_view file_name);

/// parseDbc() of a file; also throws DbcError if it cannot be read.
Database loadDbc(const std::filesystem::path& file);

}  // namespace patella::can
