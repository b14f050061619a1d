#include "drivers/can/dbc_attributes.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "drivers/can/dbc_limits.hpp"

namespace patella::can {
namespace {

/// Values of VFrameFormat for CAN FD frames, standard and extended.
constexpr double kStandardFd = 14;
constexpr double kExtendedFd = 15;

}  // namespace

std::uint32_t dbcRawId(DbcScanner& scanner) {
  return static_cast<std::uint32_t>(scanner.natural("a message identifier", 0xFFFFFFFFU));
}

void DbcAttributes::definition(DbcScanner& scanner) {
  const std::string_view object = scanner.peekWord();
  if (!object.empty()) {
    constexpr std::array<std::string_view, 4> kObjects = {"BU_", "BO_", "SG_", "EV_"};
    if (std::find(kObjects.begin(), kObjects.end(), object) == kObjects.end())
      scanner.fail("BU_, BO_, SG_, EV_ or the attribute's name in quotes");
    scanner.word(object);
  }
  const std::string name = scanner.quoted("the attribute's name in quotes");
  const std::size_t start = scanner.here();
  const std::string_view type = scanner.word("INT, HEX, FLOAT, STRING or ENUM");
  if (type == "ENUM") {
    std::vector<std::string>& values = enumerations_[name];
    values.clear();
    do {
      values.push_back(scanner.quoted("a value of the enumeration in quotes"));
      scanner.bound(values.size(), kMostDbcEnumeration, "values of an attribute");
    } while (scanner.accept(','));
  } else if (type == "INT" || type == "HEX" || type == "FLOAT") {
    while (scanner.nextIsNumber())
      scanner.number("a limit");
  } else if (type != "STRING") {
    scanner.failAt(start, "found '" + std::string(type) + "', expected INT, HEX, FLOAT, STRING or ENUM");
  }
  scanner.expect(';');
}

DbcAttributes::Value DbcAttributes::value(DbcScanner& scanner) {
  Value value;
  value.is_text = scanner.nextIs('"');
  if (value.is_text) {
    value.text = scanner.quoted("the attribute's value");
  } else {
    value.number = scanner.number("the attribute's value, a number or in quotes");
  }
  scanner.expect(';');
  return value;
}

void DbcAttributes::defaultValue(DbcScanner& scanner) {
  const std::string name = scanner.quoted("the attribute's name in quotes");
  defaults_[name] = value(scanner);
}

void DbcAttributes::attribute(DbcScanner& scanner) {
  const std::string name = scanner.quoted("the attribute's name in quotes");
  const std::string_view object = scanner.peekWord();
  if (object.empty()) {
    value(scanner);
    return;
  }
  scanner.word(object);
  if (object == "BO_") {
    const std::uint32_t raw_id = dbcRawId(scanner);
    of_message_[raw_id][name] = value(scanner);
  } else if (object == "SG_") {
    dbcRawId(scanner);
    scanner.word("a signal's name");
    value(scanner);
  } else if (object == "BU_" || object == "EV_") {
    scanner.word("a name");
    value(scanner);
  } else {
    scanner.fail("BU_, BO_, SG_, EV_ or a value before this");
  }
}

double DbcAttributes::enumerated(const std::string& name, const Value& value) const {
  if (!value.is_text)
    return value.number;
  const auto values = enumerations_.find(name);
  if (values == enumerations_.end())
    return -1.0;
  const auto found = std::find(values->second.begin(), values->second.end(), value.text);
  return found == values->second.end() ? -1.0 : static_cast<double>(found - values->second.begin());
}

void DbcAttributes::apply(Message& message) const {
  const auto own = of_message_.find(message.id | (message.extended ? kDbcExtendedFlag : 0U));
  const auto lookUp = [&](const std::string& name) -> std::optional<double> {
    if (own != of_message_.end()) {
      if (const auto found = own->second.find(name); found != own->second.end())
        return enumerated(name, found->second);
    }
    if (const auto found = defaults_.find(name); found != defaults_.end())
      return enumerated(name, found->second);
    return std::nullopt;
  };
  // Without the attribute, a length that only CAN FD carries says it.
  const std::optional<double> format = lookUp("VFrameFormat");
  message.fd = format ? *format == kStandardFd || *format == kExtendedFd : message.length > 8;
  message.bit_rate_switch = message.fd && lookUp("CANFD_BRS") == 1.0;
  if (const auto cycle_ms = lookUp("GenMsgCycleTime"); cycle_ms && *cycle_ms > 0.0)
    message.cycle_time_s = *cycle_ms / 1000.0;
}

}  // namespace patella::can
