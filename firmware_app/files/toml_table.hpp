// Typed, located reading of TOML. Every getter checks range and type, remembers that its key is known, and
// reports failures as
//   config.toml:12: key 'loop.rate_Hz': value 0, expected a number in [50, 20000]
// finish() then rejects what nobody asked for, so that a mistyped key never passes silently.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_app/files/file_error.hpp"

namespace patella::app {

/// Allowed numbers; each end belongs to the range unless declared open. NaN and infinity are never allowed.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool minimum_open = false;
  bool maximum_open = false;

  bool contains(double value) const noexcept;
  /// "in [50, 20000]", "in (0, 1]", "greater than 0", or empty without bounds.
  std::string text() const;
};

inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{.minimum = 0.0, .minimum_open = true};

/// Allowed lengths of an array.
struct CountRange {
  std::size_t minimum = 0;
  std::size_t maximum = std::numeric_limits<std::size_t>::max();

  static constexpr CountRange exactly(std::size_t count) { return {count, count}; }
};

struct TomlState;  // the parsed text and the keys asked for

/// View of one table of a document, cheap to copy; keeps the document alive. An optional table that is absent
/// reads as an empty one, so that defaults apply and required keys are reported as missing.
/// A getter without fallback requires the key. All throw FileError.
class TomlTable {
 public:
  /// Present in the file; does not count as reading it.
  bool has(std::string_view key) const;
  /// Present as a table, rather than as an array of tables, say; does not count as reading it.
  bool isTable(std::string_view key) const;
  /// Keys of the table in the order of the file; does not count as reading them.
  std::vector<std::string> keys() const;
  /// False for an optional table that the file does not have.
  bool present() const noexcept { return node_ != nullptr; }

  double number(std::string_view key, Range range = kAnyNumber) const;
  double number(std::string_view key, Range range, double fallback) const;
  std::int64_t integer(std::string_view key, std::int64_t minimum, std::int64_t maximum) const;
  std::int64_t integer(std::string_view key, std::int64_t minimum, std::int64_t maximum,
                       std::int64_t fallback) const;
  bool boolean(std::string_view key) const;
  bool boolean(std::string_view key, bool fallback) const;
  /// Not empty.
  std::string string(std::string_view key) const;
  std::string string(std::string_view key, std::string_view fallback) const;
  /// One of `allowed`; the fallback need not be.
  std::string choice(std::string_view key, std::span<const std::string> allowed) const;
  std::string choice(std::string_view key, std::span<const std::string> allowed,
                     std::string_view fallback) const;
  std::vector<double> numbers(std::string_view key, CountRange count, Range range = kAnyNumber) const;
  std::vector<double> numbers(std::string_view key, CountRange count, Range range,
                              std::span<const double> fallback) const;
  std::vector<std::string> strings(std::string_view key, CountRange count) const;
  std::vector<std::string> strings(std::string_view key, CountRange count,
                                   std::span<const std::string> fallback) const;
  /// Path named by the key, relative ones taken from the folder of the file that names them.
  std::filesystem::path path(std::string_view key) const;
  /// The same of what is there; throws where it is not.
  std::filesystem::path existing(std::string_view key) const;

  /// Sub-table, required.
  TomlTable table(std::string_view key) const;
  /// Sub-table, or an empty view.
  TomlTable optionalTable(std::string_view key) const;
  /// The tables [[key]]; none when the key is absent.
  std::vector<TomlTable> tables(std::string_view key) const;

  /// Rejects every key below this table that no getter asked for: one line a key, in the order of the file,
  /// each suggesting the nearest key that was asked for.
  void finish() const;

  /// A located error about one key, for checks that span several keys: "file:line: key 'a.b': <problem>".
  FileError error(std::string_view key, std::string_view problem) const;
  /// Full name of a key as messages show it, tables of an array counted from 1: "effect[2].joint".
  std::string fullName(std::string_view key) const;
  /// Where the table stands: "file:line: key 'effect[2]'".
  std::string origin() const;
  /// Line at which the table begins.
  std::uint32_t line() const noexcept { return line_; }

 private:
  friend class TomlDocument;
  TomlTable(std::shared_ptr<TomlState> state, const void* node, std::string prefix, std::uint32_t line);

  template <typename Read, typename Value>
  Value valueOr(std::string_view key, const Value& fallback, Read&& read) const;

  std::shared_ptr<TomlState> state_;
  const void* node_;  // toml::table, kept out of this header for the sake of compile time
  std::string prefix_;
  std::uint32_t line_;
};

class TomlDocument {
 public:
  /// Throws FileError when the file cannot be read, or "file:line:column: ..." for a syntax error.
  static TomlDocument load(const std::filesystem::path& path);
  /// `name` stands for the file in messages.
  static TomlDocument parse(std::string_view text, const std::string& name);

  const TomlTable& root() const noexcept { return root_; }
  /// root().finish().
  void finish() const { root_.finish(); }

 private:
  explicit TomlDocument(TomlTable root) : root_(std::move(root)) {}
  TomlTable root_;
};

}  // namespace patella::app
