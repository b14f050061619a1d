#include "drivers/can/dbc_scanner.hpp"

#include <charconv>
#include <system_error>

#include "drivers/can/dbc.hpp"

namespace patella::can {
namespace {

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}
bool startsWord(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

}  // namespace

void DbcScanner::skipBlank() {
  while (position_ < text_.size()) {
    if (isBlank(text_[position_])) {
      ++position_;
    } else if (text_.substr(position_).starts_with("//")) {
      const std::size_t end = text_.find('\n', position_);
      position_ = end == std::string_view::npos ? text_.size() : end;
    } else {
      return;
    }
  }
}

bool DbcScanner::atEnd() {
  skipBlank();
  return position_ == text_.size();
}

std::size_t DbcScanner::here() {
  skipBlank();
  return position_;
}

bool DbcScanner::nextIs(char c) {
  return !atEnd() && text_[position_] == c;
}

bool DbcScanner::nextIsWord() {
  return !atEnd() && startsWord(text_[position_]);
}

bool DbcScanner::nextIsNumber() {
  if (atEnd())
    return false;
  std::size_t i = position_;
  if (text_[i] == '+' || text_[i] == '-')
    ++i;
  if (i < text_.size() && text_[i] == '.')
    ++i;
  return i < text_.size() && isDigit(text_[i]);
}

bool DbcScanner::accept(char c) {
  if (!nextIs(c))
    return false;
  ++position_;
  return true;
}

void DbcScanner::expect(char c) {
  if (!accept(c))
    fail(std::string("'") + c + "'");
}

std::string_view DbcScanner::peekWord() {
  if (!nextIsWord())
    return {};
  std::size_t end = position_;
  while (end < text_.size() && (startsWord(text_[end]) || isDigit(text_[end])))
    ++end;
  return text_.substr(position_, end - position_);
}

std::string_view DbcScanner::word(std::string_view what) {
  const std::string_view result = peekWord();
  if (result.empty())
    fail(what);
  position_ += result.size();
  return result;
}

std::string DbcScanner::quoted(std::string_view what) {
  if (!nextIs('"'))
    fail(what);
  const std::size_t start = position_;
  std::string result;
  for (std::size_t i = start + 1; i < text_.size(); ++i) {
    if (text_[i] == '"') {
      position_ = i + 1;
      return result;
    }
    if (text_[i] == '\\' && i + 1 < text_.size() && text_[i + 1] == '"')
      ++i;
    result += text_[i];
  }
  failAt(start, "string is not closed before the end of the file");
}

std::string_view DbcScanner::numberText(std::string_view what) {
  if (!nextIsNumber())
    fail(what);
  std::size_t end = position_;
  const auto take = [&](auto predicate) {
    while (end < text_.size() && predicate(text_[end]))
      ++end;
  };
  if (text_[end] == '+' || text_[end] == '-')
    ++end;
  take([](char c) { return isDigit(c) || c == '.'; });
  if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'E')) {
    ++end;
    if (end < text_.size() && (text_[end] == '+' || text_[end] == '-'))
      ++end;
    take(isDigit);
  }
  // from_chars takes no plus sign.
  if (text_[position_] == '+')
    ++position_;
  return text_.substr(position_, end - position_);
}

double DbcScanner::number(std::string_view what) {
  const std::string_view digits = numberText(what);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    failAt(position_, "'" + std::string(digits) + "' is no number, expected " + std::string(what));
  }
  position_ += digits.size();
  return value;
}

std::uint64_t DbcScanner::natural(std::string_view what, std::uint64_t largest) {
  if (atEnd() || !isDigit(text_[position_]))
    fail(what);
  std::uint64_t value = 0;
  const char* const first = text_.data() + position_;
  const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), value);
  if (error != std::errc() || value > largest) {
    failAt(position_, "'" + std::string(first, end) + "' is too large, expected " + std::string(what) +
                          " of at most " + std::to_string(largest));
  }
  if (end != text_.data() + text_.size() && (*end == '.' || startsWord(*end)))
    fail(what);
  position_ += static_cast<std::size_t>(end - first);
  return value;
}

std::int64_t DbcScanner::integer(std::string_view what) {
  const std::string_view digits = numberText(what);
  const char* const last = digits.data() + digits.size();
  std::int64_t value = 0;
  std::uint64_t large = 0;
  if (const auto [end, error] = std::from_chars(digits.data(), last, value);
      error != std::errc() || end != last) {
    const auto [large_end, large_error] = std::from_chars(digits.data(), last, large);
    if (large_error != std::errc() || large_end != last) {
      failAt(position_, "'" + std::string(digits) + "' is no integer, expected " + std::string(what));
    }
    value = static_cast<std::int64_t>(large);
  }
  position_ += digits.size();
  return value;
}

void DbcScanner::skipStatement() {
  constexpr std::string_view kPunctuation = ":,|@()[]+-";
  while (!accept(';')) {
    if (nextIs('"')) {
      quoted("a string");
    } else if (nextIsNumber()) {
      number("a number");
    } else if (nextIsWord()) {
      word("a word");
    } else if (!atEnd() && kPunctuation.find(text_[position_]) != std::string_view::npos) {
      ++position_;
    } else {
      fail("';'");
    }
  }
}

std::string DbcScanner::found() {
  if (atEnd())
    return "the end of the file";
  if (nextIsWord())
    return "'" + std::string(peekWord()) + "'";
  std::size_t end = position_ + 1;
  if (nextIs('"') || nextIsNumber()) {
    while (end < text_.size() && !isBlank(text_[end]) && end - position_ < 24)
      ++end;
  }
  // A character of several bytes is quoted whole.
  while (end < text_.size() && (static_cast<unsigned char>(text_[end]) & 0xC0U) == 0x80U)
    ++end;
  return "'" + std::string(text_.substr(position_, end - position_)) + "'";
}

void DbcScanner::bound(std::size_t count, std::size_t most, std::string_view of) {
  if (count > most) {
    failAt(position_, "more than " + std::to_string(most) + " " + std::string(of) + ", expected at most " +
                          std::to_string(most));
  }
}

void DbcScanner::fail(std::string_view expected) {
  const std::string what = found();
  failAt(position_, "found " + what + ", expected " + std::string(expected));
}

void DbcScanner::failAt(std::size_t offset, std::string_view message) const {
  std::size_t line = 1;
  std::size_t column = 1;
  for (const char c : text_.substr(0, offset)) {
    if (c == '\n') {
      ++line;
      column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
      ++column;
    }
  }
  throw DbcError(file_ + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " +
                 std::string(message));
}

}  // namespace patella::can
