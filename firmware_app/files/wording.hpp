// Small parts of error messages that several readers share.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace patella::app {

/// Shortest text that reads back as the same double: "0.1", "20000", "1e-06".
std::string formatNumber(double value);
/// The same at the end of a text, without a string of its own: for tables of many rows.
void appendFormatted(std::string& text, double value);

/// Names in single quotes, separated by commas: 'a', 'b'.
std::string quotedList(std::span<const std::string> names);

/// The candidate that a typist most likely meant by `name` (edit distance, case counted as half an error,
/// a forgotten unit as one), or an empty string when none is near.
std::string nearestName(std::string_view name, std::span<const std::string> candidates);

/// ", did you mean 'x'?" for the nearest candidate, or an empty string.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace patella::app
