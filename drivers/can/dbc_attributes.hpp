// Attributes of a DBC file: what kinds there are, their defaults, and what they say of messages.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "drivers/can/dbc.hpp"
#include "drivers/can/dbc_scanner.hpp"

namespace patella::can {

/// In a raw identifier, says that it is an extended one.
inline constexpr std::uint32_t kDbcExtendedFlag = 0x80000000U;

std::uint32_t dbcRawId(DbcScanner& scanner);

/// The readers start behind the statement's keyword and throw DbcError as the scanner does.
class DbcAttributes {
 public:
  void definition(DbcScanner& scanner);    ///< BA_DEF_
  void defaultValue(DbcScanner& scanner);  ///< BA_DEF_DEF_
  void attribute(DbcScanner& scanner);     ///< BA_

  /// Sets what attributes say of a message: CAN FD, its bit rate switch, its cycle time.
  void apply(Message& message) const;

 private:
  /// Text or a number; an enumeration may be given as either.
  struct Value {
    std::string text;
    double number = 0.0;
    bool is_text = false;
  };

  static Value value(DbcScanner& scanner);
  double enumerated(const std::string& name, const Value& value) const;

  std::map<std::string, std::vector<std::string>> enumerations_;
  std::map<std::string, Value> defaults_;
  std::map<std::uint32_t, std::map<std::string, Value>> of_message_;  ///< by raw identifier
};

}  // namespace patella::can
