// Words, numbers and strings of a DBC file, and where each stands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace patella::can {

/// Reads on demand, as what a character means (the minus of `8-9` or of `-9`) depends on the statement. Every
/// function skips blanks and `//` comments first, and throws DbcError naming what was found and expected.
class DbcScanner {
 public:
  DbcScanner(std::string_view text, std::string_view file_name) : text_(text), file_(file_name) {}

  bool atEnd();
  /// Offset of the next character that counts; for failAt().
  std::size_t here();

  bool nextIs(char c);
  bool nextIsWord();
  bool nextIsNumber();
  bool accept(char c);
  void expect(char c);

  std::string_view peekWord();
  std::string_view word(std::string_view what);
  std::string quoted(std::string_view what);
  double number(std::string_view what);
  std::uint64_t natural(std::string_view what, std::uint64_t largest);
  /// Also takes values above the signed range, wrapped: some tools list the names of 64-bit values so.
  std::int64_t integer(std::string_view what);

  /// Skips words, numbers, strings and punctuation up to and with the semicolon.
  void skipStatement();

  /// Fails where there are more of something than a description may have.
  void bound(std::size_t count, std::size_t most, std::string_view of);
  [[noreturn]] void fail(std::string_view expected);
  [[noreturn]] void failAt(std::size_t offset, std::string_view message) const;

 private:
  void skipBlank();
  std::string found();
  std::string_view numberText(std::string_view what);

  std::string_view text_;
  std::string file_;
  std::size_t position_ = 0;
};

}  // namespace patella::can
