// Reading of the numbers that core/bounds knows: the key is the last part of the row's name, the range the
// row's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/bounds/bounds.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

/// The range that a file may use, or that of a rehearsal.
Range rangeOf(const Bound& bound, bool rehearsal = false) noexcept;

/// Without a fallback the key is required. All throw FileError naming file, line, key, value and range.
double number(const TomlTable& table, const Bound& bound);
double number(const TomlTable& table, const Bound& bound, double fallback, bool rehearsal = false);
std::vector<double> numbers(const TomlTable& table, const Bound& bound, CountRange count);
std::vector<double> numbers(const TomlTable& table, const Bound& bound, CountRange count,
                            std::span<const double> fallback);
/// A row of whole numbers.
std::int64_t integer(const TomlTable& table, const Bound& bound);
std::int64_t integer(const TomlTable& table, const Bound& bound, std::int64_t fallback,
                     bool rehearsal = false);
template <typename Integer>
void readInteger(const TomlTable& table, const Bound& bound, Integer& value, bool rehearsal = false) {
  value = static_cast<Integer>(integer(table, bound, static_cast<std::int64_t>(value), rehearsal));
}

/// Throws std::invalid_argument "<option>: value <value>, expected a number in [<minimum>, <maximum>]".
void requireArgument(const char* option, const Bound& bound, double value);

}  // namespace patella::app
