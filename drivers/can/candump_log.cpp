#include "drivers/can/candump_log.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

#include "drivers/can/message_codec.hpp"

namespace patella::can {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000U;
constexpr std::uint32_t kExtendedMask = 0x1FFFFFFFU;
constexpr std::uint32_t kStandardMask = 0x7FFU;
constexpr unsigned kBitRateSwitchFlag = 0x1;
constexpr unsigned kFdFrameFlag = 0x4;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMicrosecond_ns = 1'000;

[[noreturn]] void refuse(std::string_view found, const std::string& expected) {
  throw std::invalid_argument(
      (found.empty() ? std::string("the line ends") : "found '" + std::string(found.substr(0, 40)) + "'") +
      ", expected " + expected);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9')
    return c - '0';
  if (c >= 'A' && c <= 'F')
    return c - 'A' + 10;
  if (c >= 'a' && c <= 'f')
    return c - 'a' + 10;
  return -1;
}

/// Takes the characters up to the next blank, and the blanks after it.
std::string_view takeWord(std::string_view& rest) {
  const std::size_t end = std::min(rest.find(' '), rest.size());
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(std::min(rest.find_first_not_of(' ', end), rest.size()));
  return word;
}

std::int64_t parseStamp(std::string_view word) {
  const std::string expected = "a stamp such as (1604665770.960915)";
  if (word.size() < 4 || word.front() != '(' || word.back() != ')')
    refuse(word, expected);
  const std::string_view inner = word.substr(1, word.size() - 2);
  const std::size_t dot = inner.find('.');
  const std::size_t decimals = dot == std::string_view::npos ? 0 : inner.size() - dot - 1;
  // Microseconds from candump, nanoseconds from some who write its format.
  if (decimals != 6 && decimals != 9)
    refuse(word, expected);
  std::int64_t seconds = 0;
  std::int64_t fraction = 0;
  const char* const end = inner.data() + inner.size();
  const auto whole = std::from_chars(inner.data(), inner.data() + dot, seconds);
  const auto part = std::from_chars(inner.data() + dot + 1, end, fraction);
  const bool parsed =
      whole.ec == std::errc() && whole.ptr == inner.data() + dot && part.ec == std::errc() && part.ptr == end;
  if (!parsed || seconds < 0 || fraction < 0 ||
      seconds >= std::numeric_limits<std::int64_t>::max() / kSecond_ns) {
    refuse(word, expected);
  }
  return seconds * kSecond_ns + fraction * (decimals == 6 ? kMicrosecond_ns : 1);
}

void parseIdentifier(std::string_view digits, Frame& frame) {
  const std::string expected = "an identifier of 3 or 8 hexadecimal digits";
  if (digits.size() != 3 && digits.size() != 8)
    refuse(digits, expected);
  std::uint32_t id = 0;
  for (const char c : digits) {
    const int value = hexDigit(c);
    if (value < 0)
      refuse(digits, expected);
    id = id << 4U | static_cast<std::uint32_t>(value);
  }
  frame.error = digits.size() == 8 && (id & kErrorFlag) != 0 && id <= (kErrorFlag | kExtendedMask);
  frame.extended = digits.size() == 8 && !frame.error;
  frame.id = frame.error ? id & kExtendedMask : id;
  if (frame.id > (digits.size() == 3 ? kStandardMask : kExtendedMask)) {
    refuse(digits, digits.size() == 3 ? "an identifier of at most 7FF" : "an identifier of at most 1FFFFFFF");
  }
}

void parseData(std::string_view digits, Frame& frame) {
  const std::size_t largest = frame.fd ? 64 : 8;
  if (digits.size() % 2 != 0)
    refuse(digits, "an even number of hexadecimal digits");
  if (digits.size() / 2 > largest)
    refuse(digits, "at most " + std::to_string(largest) + " bytes of data");
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const int high = hexDigit(digits[i]);
    const int low = hexDigit(digits[i + 1]);
    if (high < 0 || low < 0)
      refuse(digits.substr(i), "hexadecimal digits of data");
    frame.data[i / 2] = static_cast<std::uint8_t>(high << 4 | low);
  }
  frame.length = static_cast<std::uint8_t>(digits.size() / 2);
  if (fdLength(frame.length) != frame.length)
    refuse(digits, "a length that CAN FD has");
}

void parseFrame(std::string_view word, LogEntry& entry) {
  Frame& frame = entry.frame;
  const std::size_t hash = word.find('#');
  if (hash == std::string_view::npos)
    refuse(word, "a frame such as 202#9019F500");
  parseIdentifier(word.substr(0, hash), frame);
  std::string_view data = word.substr(hash + 1);
  if (data.starts_with('#')) {
    const int flags = data.size() > 1 ? hexDigit(data[1]) : -1;
    if (flags < 0 || frame.error)
      refuse(data, "the flags of a CAN FD frame, one hexadecimal digit");
    entry.fd_flags = static_cast<std::uint8_t>(flags);
    frame.fd = true;
    frame.bit_rate_switch = (static_cast<unsigned>(flags) & kBitRateSwitchFlag) != 0;
    data.remove_prefix(2);
  } else if (data.starts_with('R')) {
    frame.remote = true;
    const int length = data.size() == 2 ? hexDigit(data[1]) : 0;
    if (data.size() > 2 || length < 0 || length > 8)
      refuse(data, "R or R with a length of at most 8");
    frame.length = static_cast<std::uint8_t>(length);
    return;
  }
  parseData(data, frame);
}

/// Appends to a buffer and remembers whether it was too small.
class Appender {
 public:
  explicit Appender(std::span<char> out) noexcept : out_(out) {}

  void put(char c) noexcept {
    if (size_ < out_.size())
      out_[size_] = c;
    ++size_;
  }
  void put(std::string_view text) noexcept {
    for (const char c : text)
      put(c);
  }
  void decimal(std::int64_t value, int width) noexcept {
    std::int64_t power = 1;
    for (int i = 1; i < width || value / power >= 10; ++i)
      power *= 10;
    for (; power > 0; power /= 10)
      put(static_cast<char>('0' + value / power % 10));
  }
  void hex(std::uint32_t value, int width) noexcept {
    for (int i = width - 1; i >= 0; --i) {
      put("0123456789ABCDEF"[(value >> (4U * static_cast<unsigned>(i))) & 0xFU]);
    }
  }
  std::size_t size() const noexcept { return size_ <= out_.size() ? size_ : 0; }

 private:
  std::span<char> out_;
  std::size_t size_ = 0;
};

std::size_t format(std::span<char> out, const Frame& frame, std::string_view interface, unsigned fd_flags,
                   char direction) noexcept {
  Appender line(out);
  line.put('(');
  const std::int64_t wall_ns = std::max<std::int64_t>(frame.wall_ns, 0);
  line.decimal(wall_ns / kSecond_ns, 10);
  line.put('.');
  line.decimal(wall_ns % kSecond_ns / kMicrosecond_ns, 6);
  line.put(") ");
  line.put(interface);
  line.put(' ');
  const bool wide = frame.extended || frame.error;
  line.hex(frame.error ? frame.id | kErrorFlag : frame.id, wide ? 8 : 3);
  line.put('#');
  if (frame.remote) {
    line.put('R');
    if (frame.length > 0)
      line.hex(frame.length, 1);
  } else {
    if (frame.fd) {
      line.put('#');
      line.hex(fd_flags, 1);
    }
    for (std::size_t i = 0; i < frame.length; ++i)
      line.hex(frame.data[i], 2);
  }
  if (direction != '\0') {
    line.put(' ');
    line.put(direction);
  }
  line.put('\n');
  return line.size();
}

}  // namespace

void parseLogLine(std::string_view line, LogEntry& entry) {
  if (line.ends_with('\r'))
    line.remove_suffix(1);
  entry.frame = Frame{};
  entry.direction = '\0';
  entry.fd_flags = 0;
  entry.frame.wall_ns = parseStamp(takeWord(line));
  const std::string_view interface = takeWord(line);
  if (interface.empty() || interface.size() > kMaxInterfaceName) {
    refuse(interface, "an interface's name of at most 15 characters");
  }
  entry.interface = interface;
  parseFrame(takeWord(line), entry);
  if (const std::string_view direction = takeWord(line); !direction.empty()) {
    if (direction != "R" && direction != "T")
      refuse(direction, "the direction R or T, or the end of the line");
    entry.direction = direction.front();
    entry.frame.own = entry.direction == 'T';
  }
  if (!line.empty())
    refuse(line, "the end of the line");
}

std::size_t formatLogLine(std::span<char> out, const Frame& frame, std::string_view interface) noexcept {
  const unsigned fd_flags = kFdFrameFlag | (frame.bit_rate_switch ? kBitRateSwitchFlag : 0U);
  return format(out, frame, interface, fd_flags, '\0');
}

std::size_t formatLogLine(std::span<char> out, const LogEntry& entry) noexcept {
  return format(out, entry.frame, entry.interface, entry.fd_flags, entry.direction);
}

CandumpReader::CandumpReader(const std::filesystem::path& file) : name_(file.string()) {
  try {
    lines_.emplace(file, kLongestReadLine);
  } catch (const std::runtime_error& error) {
    throw LogError(error.what());
  }
}

bool CandumpReader::nextLine() {
  try {
    return lines_->next(text_);
  } catch (const std::runtime_error& error) {
    throw LogError(error.what());
  }
}

bool CandumpReader::next(LogEntry& entry) {
  while (nextLine()) {
    if (text_.empty() || text_ == "\r")
      continue;
    try {
      parseLogLine(text_, entry);
    } catch (const std::invalid_argument& error) {
      if (unterminated() && found_) {
        cut_line_ = line();
        return false;
      }
      throw LogError(name_ + ":" + std::to_string(line()) + ": " + error.what());
    }
    found_ = true;
    return true;
  }
  return false;
}

}  // namespace patella::can
