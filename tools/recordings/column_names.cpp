#include "tools/recordings/column_names.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/files/line_reader.hpp"
#include "firmware_app/files/csv_parser.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/recordings/units.hpp"

namespace patella::diagnose {
namespace {

constexpr std::size_t kMostNamesListed = 12;
constexpr std::size_t kLongestLine = 1'000'000;

struct Delimiter {
  char letter;
  const char* plural;
  const char* in_map;
};
constexpr std::array kDelimiters{Delimiter{',', "commas", "comma"}, Delimiter{';', "semicolons", "semicolon"},
                                 Delimiter{'\t', "tabs", "tab"}, Delimiter{' ', "spaces", "space"}};

const char* pluralOf(char letter) {
  return std::find_if(kDelimiters.begin(), kDelimiters.end(),
                      [&](const Delimiter& delimiter) { return delimiter.letter == letter; })
      ->plural;
}

std::vector<std::string> without(std::span<const std::string> names, std::span<const std::string> others) {
  std::vector<std::string> rest;
  std::copy_if(names.begin(), names.end(), std::back_inserter(rest), [&](const std::string& name) {
    return std::find(others.begin(), others.end(), name) == others.end();
  });
  return rest;
}

/// Of the first row below a header: a cell that is a number with a decimal comma, or nothing.
std::string decimalCommaIn(const std::string& file, char delimiter) {
  std::string row;
  try {
    files::LineReader lines(file, kLongestLine);
    if (!lines.next(row) || !lines.next(row)) {
      return {};
    }
  } catch (const std::runtime_error&) {
    return {};  // what is wrong with the header is said all the same
  }
  for (std::size_t at = 0; at < row.size();) {
    const std::size_t end = std::min(row.find(delimiter, at), row.size());
    const std::string cell = row.substr(at, end - at);
    if (app::hasDecimalComma(cell)) {
      return cell;
    }
    at = end + 1;
  }
  return {};
}

/// What separates the names of a header that was read as one: nothing where it is one. A name may have
/// spaces.
std::string otherDelimiter(const std::string& file, std::span<const std::string> header, char expected) {
  for (const Delimiter& delimiter : kDelimiters) {
    if (header.size() == 1 && delimiter.letter != expected && delimiter.letter != ' ' &&
        header.front().find(delimiter.letter) != std::string::npos) {
      const std::string number = delimiter.letter == ',' ? "" : decimalCommaIn(file, delimiter.letter);
      return fmt::format(
          "the columns seem to be separated by {}, expected {}, or a map of the columns (--columns) with "
          "delimiter = \"{}\"{}",
          delimiter.plural, pluralOf(expected), delimiter.in_map,
          number.empty() ? ""
                         : "; numbers have decimal commas, as '" + number + "', expected decimal points");
    }
  }
  return {};
}

/// "q1_rad" or "q1 [deg]" as the signal and its unit.
struct Measured {
  std::string signal;
  std::string unit;
};

Measured measured(const std::string& column) {
  constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  const std::size_t end = std::min(column.find_first_of("_ [("), column.size());
  Measured result{column.substr(0, end), ""};
  std::copy_if(column.begin() + static_cast<std::ptrdiff_t>(end), column.end(),
               std::back_inserter(result.unit),
               [&](char c) { return std::string_view(kLetters).find(c) != std::string_view::npos; });
  return result;
}

/// How a map takes a column with the unit that its name tells, such as "N.mm" for "Nmm"; nothing for others.
std::string mapLine(const Measured& wanted, const Measured& there, const std::string& column) {
  const bool time = wanted.signal == "t";
  const bool torque = wanted.signal.starts_with("tau");
  if (wanted.unit.empty() || !(time || torque || wanted.signal.starts_with('q'))) {
    return {};
  }
  const Quantity quantity = time ? Quantity::kTime : torque ? Quantity::kTorque : Quantity::kPosition;
  for (const Unit& unit : unitsOf(quantity)) {
    std::string letters(unit.name);
    std::erase(letters, '.');
    if (letters == there.unit && there.unit != wanted.unit) {
      return time ? fmt::format("time_column = \"{}\" and time_unit = \"{}\"", column, unit.name)
                  : fmt::format("{} = {{ column = \"{}\", unit = \"{}\" }}", torque ? "torque" : "position",
                                column, unit.name);
    }
  }
  return {};
}

/// Of the first missing column that is there in another unit: what to do about it. Nothing where none is.
std::string otherUnit(std::span<const std::string> missing, std::span<const std::string> header) {
  for (const std::string& name : missing) {
    const Measured wanted = measured(name);
    for (const std::string& column : header) {
      const Measured there = measured(column);
      const std::string line = there.signal == wanted.signal ? mapLine(wanted, there, column) : "";
      if (!line.empty()) {
        return fmt::format(
            "'{}' has another unit than '{}', expected a map of the columns (--columns) with {}", column,
            name, line);
      }
    }
  }
  return {};
}

// A file that holds no text may have a line of any length.
std::string shortened(const std::string& name) {
  constexpr std::size_t kLongestName = 40;
  return name.size() <= kLongestName ? name : name.substr(0, kLongestName) + "…";
}

std::string found(std::span<const std::string> header) {
  const std::size_t listed = std::min(header.size(), kMostNamesListed);
  std::vector<std::string> names;
  std::transform(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(listed),
                 std::back_inserter(names), shortened);
  return "the file has " + app::quotedList(names) +
         (listed < header.size() ? fmt::format(" and {} more", header.size() - listed) : "");
}

}  // namespace

std::string firstLineOf(const std::filesystem::path& file) {
  try {
    std::string line;
    files::LineReader(file, kLongestLine).next(line);
    return line;
  } catch (const app::FileError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw app::FileError(error.what());
  }
}

std::vector<std::string> namesIn(const std::string& header, const std::string& file, char delimiter) {
  return app::CsvTable::parse(header, file, {.delimiter = delimiter, .minimum_rows = 0}).names();
}

void requireColumns(const std::string& file, std::span<const std::string> header,
                    std::span<const std::string> needed, const HeaderForm& form) {
  const std::vector<std::string> missing = without(needed, header);
  if (missing.empty()) {
    return;
  }
  std::string problem = "there is no column '" + missing.front() + "'";
  if (missing.size() > 1) {
    problem += ", nor " + app::quotedList(std::span(missing).subspan(1));
  }
  for (const std::string& remedy :
       {otherDelimiter(file, header, form.delimiter), otherUnit(missing, header)}) {
    if (!remedy.empty()) {
      throw app::FileError(fmt::format("{}:1: {}; {}", file, problem, remedy));
    }
  }
  // A file of which no name is known has names of its own: the nearest of them may mean anything.
  if (missing.size() < needed.size()) {
    problem += app::suggestion(missing.front(), without(header, needed));
  }
  throw app::FileError(fmt::format("{}:1: {}; {}{}", file, problem, found(header), form.remedy));
}

}  // namespace patella::diagnose
