#include "tools/recordings/column_names.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/files/line_reader.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::diagnose {
namespace {

constexpr std::size_t kMostNamesListed = 12;

struct Delimiter {
  char letter;
  const char* plural;
};
constexpr std::array kDelimiters{Delimiter{',', "commas"}, Delimiter{';', "semicolons"},
                                 Delimiter{'\t', "tabs"}, Delimiter{' ', "spaces"}};

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

/// What separates the names of a header that was read as one: nothing where it is one. A name may have
/// spaces.
std::string otherDelimiter(std::span<const std::string> header, const HeaderForm& form) {
  for (const Delimiter& delimiter : kDelimiters) {
    if (header.size() == 1 && delimiter.letter != form.delimiter && delimiter.letter != ' ' &&
        header.front().find(delimiter.letter) != std::string::npos) {
      return fmt::format("the columns seem to be separated by {}, expected {}", delimiter.plural,
                         pluralOf(form.delimiter));
    }
  }
  return {};
}

std::string found(std::span<const std::string> header) {
  const std::size_t listed = std::min(header.size(), kMostNamesListed);
  return "the file has " + app::quotedList(header.first(listed)) +
         (listed < header.size() ? fmt::format(" and {} more", header.size() - listed) : "");
}

}  // namespace

std::string firstLineOf(const std::filesystem::path& file) {
  constexpr std::size_t kLongestLine = 1'000'000;
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
  // A file of which no name is known has names of its own: the nearest of them may mean anything.
  if (missing.size() < needed.size()) {
    problem += app::suggestion(missing.front(), without(header, needed));
  }
  const std::string other = otherDelimiter(header, form);
  throw app::FileError(
      fmt::format("{}:1: {}; {}{}", file, problem, other.empty() ? found(header) : other, form.remedy));
}

}  // namespace patella::diagnose
