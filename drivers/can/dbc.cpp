#include "drivers/can/dbc.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "drivers/can/dbc_attributes.hpp"
#include "drivers/can/dbc_check.hpp"
#include "drivers/can/dbc_keywords.hpp"
#include "drivers/can/dbc_limits.hpp"
#include "drivers/can/dbc_scanner.hpp"
#include "drivers/can/text_encoding.hpp"

namespace patella::can {
namespace {

constexpr std::uint32_t kLargestStandardId = 0x7FFU;
constexpr std::uint32_t kLargestExtendedId = 0x1FFFFFFFU;
/// VECTOR__INDEPENDENT_SIG_MSG, where Vector's editors keep signals that no message uses.
constexpr std::uint32_t kIndependentSignals = 0xC0000000U;
/// The longest message that J1939's transport protocol carries, bytes.
constexpr std::uint64_t kLargestLength = 1785;

std::string hex(std::uint32_t id) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (; id != 0 || text.empty(); id >>= 4U)
    text.insert(text.begin(), kDigits[id & 0xFU]);
  return "0x" + text;
}

class Parser {
 public:
  Parser(std::string_view text, std::string_view file_name) : scanner_(text, file_name) {
    database_.source = file_name;
  }

  Database parse() {
    while (!scanner_.atEnd())
      statement();
    finish();
    return std::move(database_);
  }

 private:
  void statement();
  void newSymbols();
  void bitTiming();
  void nodes();
  void message();
  void signal(Message& message, DbcMarks& marks);
  void multiplexIndicator(Signal& signal);
  void transmitters();
  void comment();
  void valueNames();
  void valueType();
  void multiplexedValues();
  void finish();

  std::uint32_t rawId() { return dbcRawId(scanner_); }
  Message* messageOf(std::uint32_t raw_id);
  /// The named signal of a statement whose loss would change how data are decoded.
  std::pair<Message*, Signal*> requiredSignal();

  DbcScanner scanner_;
  Database database_;
  std::vector<DbcMarks> marks_;
  std::unordered_map<std::uint32_t, std::size_t> by_id_;  ///< place of each message, by raw identifier
  std::unordered_set<std::string> names_;
  std::size_t signals_ = 0;
  std::size_t ranges_ = 0;
  Message independent_;
  DbcAttributes attributes_;
};

void Parser::statement() {
  const std::size_t start = scanner_.here();
  const std::string_view keyword = scanner_.word("a statement such as BO_, CM_ or VAL_");
  if (keyword == "VERSION") {
    database_.version = scanner_.quoted("the version in quotes");
  } else if (keyword == "NS_") {
    newSymbols();
  } else if (keyword == "BS_") {
    bitTiming();
  } else if (keyword == "BU_") {
    nodes();
  } else if (keyword == "BO_") {
    message();
  } else if (keyword == "BO_TX_BU_") {
    transmitters();
  } else if (keyword == "CM_") {
    comment();
  } else if (keyword == "BA_DEF_") {
    attributes_.definition(scanner_);
  } else if (keyword == "BA_DEF_DEF_") {
    attributes_.defaultValue(scanner_);
  } else if (keyword == "BA_") {
    attributes_.attribute(scanner_);
  } else if (keyword == "VAL_") {
    valueNames();
  } else if (keyword == "SG_MUL_VAL_") {
    multiplexedValues();
  } else if (keyword == "SIG_VALTYPE_") {
    valueType();
  } else if (contains(kSkippedStatements, keyword)) {
    scanner_.skipStatement();
  } else if (keyword == "SG_") {
    scanner_.failAt(start, "found 'SG_' outside a message, expected a statement such as BO_, CM_ or VAL_");
  } else {
    scanner_.failAt(start,
                    "found '" + std::string(keyword) + "', expected a statement such as BO_, CM_ or VAL_");
  }
}

void Parser::newSymbols() {
  // The list holds keywords, so only the sections that never stand in it can end it.
  constexpr std::array<std::string_view, 3> kEnd = {"BS_", "BU_", "BO_"};
  scanner_.expect(':');
  while (!scanner_.atEnd() && !contains(kEnd, scanner_.peekWord()))
    scanner_.word("a symbol's name or BS_");
}

void Parser::bitTiming() {
  scanner_.expect(':');
  if (!scanner_.nextIsNumber())
    return;
  scanner_.number("a baud rate");
  scanner_.expect(':');
  scanner_.number("BTR1");
  scanner_.expect(',');
  scanner_.number("BTR2");
}

void Parser::nodes() {
  scanner_.expect(':');
  while (scanner_.nextIsWord() && !isKeyword(scanner_.peekWord())) {
    database_.nodes.emplace_back(scanner_.word("a node's name"));
  }
}

void Parser::message() {
  const std::size_t start = scanner_.here();
  const std::uint32_t raw_id = rawId();
  Message message;
  DbcMarks marks;
  message.extended = (raw_id & kDbcExtendedFlag) != 0;
  message.id = raw_id & ~kDbcExtendedFlag;
  marks.message = scanner_.here();
  message.name = scanner_.word("the message's name");
  scanner_.expect(':');
  message.length = static_cast<int>(scanner_.natural("the message's length in bytes", kLargestLength));
  message.senders.emplace_back(scanner_.word("the sender's name"));
  const bool independent = raw_id == kIndependentSignals;
  while (scanner_.peekWord() == "SG_") {
    signal(message, marks);
    scanner_.bound(message.signals.size(), independent ? kMostDbcIndependentSignals : kMostDbcMessageSignals,
                   "signals of a message");
    scanner_.bound(++signals_, kMostDbcSignals, "signals");
  }
  if (independent) {
    independent_ = std::move(message);
    return;
  }
  if (message.id > (message.extended ? kLargestExtendedId : kLargestStandardId)) {
    scanner_.failAt(start, std::string(message.extended ? "extended" : "standard") + " identifier " +
                               hex(message.id) + " of message '" + message.name + "' is wider than " +
                               (message.extended ? "29" : "11") + " bits");
  }
  if (const Message* other = messageOf(raw_id)) {
    scanner_.failAt(start, "messages '" + other->name + "' and '" + message.name + "' share the identifier " +
                               hex(message.id));
  }
  if (!names_.insert(message.name).second) {
    scanner_.failAt(marks.message, "a message '" + message.name + "' is defined already");
  }
  scanner_.bound(database_.messages.size() + 1, kMostDbcMessages, "messages");
  by_id_[raw_id] = database_.messages.size();
  database_.messages.push_back(std::move(message));
  marks_.push_back(std::move(marks));
}

void Parser::multiplexIndicator(Signal& signal) {
  if (scanner_.nextIs(':'))
    return;
  const std::size_t start = scanner_.here();
  const std::string_view indicator = scanner_.word("':' or a multiplexing indicator (M, m<N> or m<N>M)");
  std::string_view rest = indicator;
  if (rest.ends_with('M')) {
    signal.is_multiplexor = true;
    rest.remove_suffix(1);
  }
  if (rest.empty())
    return;
  std::uint64_t value = 0;
  std::size_t digits = 1;
  for (; digits < rest.size() && rest[digits] >= '0' && rest[digits] <= '9' && digits < 19; ++digits) {
    value = value * 10 + static_cast<std::uint64_t>(rest[digits] - '0');
  }
  if (rest.front() != 'm' || rest.size() < 2 || digits != rest.size()) {
    scanner_.failAt(start, "found '" + std::string(indicator) +
                               "', expected ':' or a multiplexing indicator (M, m<N> or m<N>M)");
  }
  signal.multiplex_ranges = {{value, value}};
}

void Parser::signal(Message& message, DbcMarks& marks) {
  scanner_.word("SG_");
  Signal signal;
  const std::size_t start = scanner_.here();
  signal.name = scanner_.word("the signal's name");
  multiplexIndicator(signal);
  scanner_.expect(':');
  signal.start_bit = static_cast<int>(scanner_.natural("the start bit", 8 * kLargestLength - 1));
  scanner_.expect('|');
  const std::size_t length = scanner_.here();
  signal.length = static_cast<int>(scanner_.natural("the length in bits", 8 * kLargestLength));
  if (signal.length == 0)
    scanner_.failAt(length, "signal '" + signal.name + "' has no bits");
  scanner_.expect('@');
  const std::size_t order = scanner_.here();
  const std::uint64_t byte_order = scanner_.natural("the byte order, 0 (Motorola) or 1 (Intel)", 9);
  if (byte_order > 1)
    scanner_.failAt(order, "expected the byte order, 0 (Motorola) or 1 (Intel)");
  signal.byte_order = byte_order == 1 ? ByteOrder::kIntel : ByteOrder::kMotorola;
  signal.is_signed = scanner_.accept('-');
  if (!signal.is_signed && !scanner_.accept('+'))
    scanner_.fail("'+' (unsigned) or '-' (signed)");
  scanner_.expect('(');
  signal.factor = scanner_.number("the factor");
  scanner_.expect(',');
  signal.offset = scanner_.number("the offset");
  scanner_.expect(')');
  scanner_.expect('[');
  signal.minimum = scanner_.number("the minimum");
  scanner_.expect('|');
  signal.maximum = scanner_.number("the maximum");
  scanner_.expect(']');
  signal.unit = scanner_.quoted("the unit in quotes");
  while (scanner_.nextIsWord() && !isKeyword(scanner_.peekWord())) {
    signal.receivers.emplace_back(scanner_.word("a receiver's name"));
    if (scanner_.accept(',') && !scanner_.nextIsWord())
      scanner_.fail("a receiver's name");
  }
  message.signals.push_back(std::move(signal));
  marks.signals.push_back(start);
}

Message* Parser::messageOf(std::uint32_t raw_id) {
  if (raw_id == kIndependentSignals)
    return &independent_;
  const auto found = by_id_.find(raw_id);
  return found == by_id_.end() ? nullptr : &database_.messages[found->second];
}

std::pair<Message*, Signal*> Parser::requiredSignal() {
  const std::size_t start = scanner_.here();
  Message* message = messageOf(rawId());
  if (message == nullptr)
    scanner_.failAt(start, "no message has this identifier");
  const std::size_t name = scanner_.here();
  const std::string_view signal = scanner_.word("a signal's name");
  auto* found = const_cast<Signal*>(message->find(signal));
  if (found == nullptr) {
    scanner_.failAt(name, "message '" + message->name + "' has no signal '" + std::string(signal) + "'");
  }
  return {message, found};
}

void Parser::transmitters() {
  Message* message = messageOf(rawId());
  scanner_.expect(':');
  std::vector<std::string> senders;
  while (scanner_.nextIsWord()) {
    senders.emplace_back(scanner_.word("a sender's name"));
    scanner_.bound(senders.size() + (message == nullptr ? 0 : message->senders.size()), kMostDbcSenders,
                   "senders of a message");
    scanner_.accept(',');
  }
  scanner_.expect(';');
  if (message == nullptr)
    return;
  for (std::string& sender : senders) {
    if (!contains(message->senders, sender))
      message->senders.push_back(std::move(sender));
  }
}

void Parser::comment() {
  const std::string_view kind = scanner_.peekWord();
  std::string unused;
  std::string* target = &unused;
  if (kind == "BU_" || kind == "EV_") {
    scanner_.word(kind);
    scanner_.word("a name");
  } else if (kind == "BO_" || kind == "SG_") {
    scanner_.word(kind);
    Message* message = messageOf(rawId());
    if (kind == "BO_") {
      if (message != nullptr)
        target = &message->comment;
    } else {
      const std::string_view name = scanner_.word("a signal's name");
      auto* signal = message == nullptr ? nullptr : const_cast<Signal*>(message->find(name));
      if (signal != nullptr)
        target = &signal->comment;
    }
  } else if (kind.empty()) {
    target = &database_.comment;
  } else {
    scanner_.fail("BU_, BO_, SG_, EV_ or a comment in quotes");
  }
  *target = scanner_.quoted("a comment in quotes");
  scanner_.expect(';');
}

void Parser::valueNames() {
  Signal unused;
  Signal* signal = &unused;
  if (scanner_.nextIsNumber()) {
    Message* message = messageOf(rawId());
    const std::string_view name = scanner_.word("a signal's name");
    auto* found = message == nullptr ? nullptr : const_cast<Signal*>(message->find(name));
    if (found != nullptr)
      signal = found;
  } else {
    scanner_.word("a message identifier or the name of an environment variable");
  }
  while (!scanner_.accept(';')) {
    const std::int64_t value = scanner_.integer("a value or ';'");
    signal->value_names[value] = scanner_.quoted("the value's name in quotes");
  }
}

void Parser::valueType() {
  Signal* signal = requiredSignal().second;
  scanner_.accept(':');
  const std::size_t start = scanner_.here();
  const std::uint64_t type =
      scanner_.natural("a value type, 0 (integer), 1 (32-bit float) or 2 (64-bit float)", 3);
  if (type > 2) {
    scanner_.failAt(start, "found '3', expected 0 (integer), 1 (32-bit float) or 2 (64-bit float)");
  }
  signal->type = static_cast<ValueType>(type);
  scanner_.expect(';');
}

void Parser::multiplexedValues() {
  const auto [message, signal] = requiredSignal();
  const std::size_t start = scanner_.here();
  const std::string name(scanner_.word("the multiplexor's name"));
  const Signal* above = message->find(name);
  if (above == nullptr || !above->is_multiplexor) {
    scanner_.failAt(start, "'" + name + "' is no multiplexor ('M') of message '" + message->name + "'");
  }
  signal->multiplexor = name;
  signal->multiplex_ranges.clear();
  do {
    const std::size_t range_start = scanner_.here();
    MultiplexRange range;
    range.first = scanner_.natural("the first value of a range", UINT64_MAX);
    scanner_.expect('-');
    range.last = scanner_.natural("the last value of a range", UINT64_MAX);
    if (range.last < range.first)
      scanner_.failAt(range_start, "range ends before it begins");
    signal->multiplex_ranges.push_back(range);
    scanner_.bound(++ranges_, kMostDbcRanges, "ranges of multiplexors");
  } while (scanner_.accept(','));
  scanner_.expect(';');
}

void Parser::finish() {
  for (Message& message : database_.messages)
    attributes_.apply(message);
  const DbcReporter report = [this](std::size_t offset, std::string_view text) {
    scanner_.failAt(offset, text);
  };
  for (std::size_t i = 0; i < database_.messages.size(); ++i) {
    completeAndCheck(database_.messages[i], marks_[i], report);
  }
}

}  // namespace

Database parseDbc(std::string_view text, std::string_view file_name) {
  const std::string utf8 = toUtf8(text);
  return Parser(utf8, file_name).parse();
}

}  // namespace patella::can
