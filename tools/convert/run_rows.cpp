#include "tools/convert/run_rows.hpp"

#include <charconv>
#include <limits>

#include "firmware_app/files/file_error.hpp"

namespace patella::convert {
namespace {

constexpr std::size_t kLongestRow = 1'000'000;

/// Calls visit(cell) for each cell of a line.
template <typename Visitor>
void forEachCell(std::string_view line, Visitor&& visit) {
  while (true) {
    const std::size_t comma = line.find(',');
    visit(line.substr(0, comma));
    if (comma == std::string_view::npos) {
      return;
    }
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

RunRows::RunRows(const std::filesystem::path& file) : name_(file.string()), lines_(file, kLongestRow) {
  if (!lines_.next(line_) || line_.empty()) {
    throw app::FileError(name_ + ": is empty, expected the columns of a run");
  }
  bytes_read_ = line_.size() + 1;
  forEachCell(line_, [&](std::string_view cell) { columns_.emplace_back(cell); });
}

bool RunRows::next(std::vector<double>& row) {
  // The recorder ends every line: one without a line feed was being written.
  if (!lines_.next(line_) || lines_.unterminated()) {
    return false;
  }
  bytes_read_ += line_.size() + 1;
  row.clear();
  forEachCell(line_, [&](std::string_view cell) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!cell.empty()) {
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error != std::errc() || end != cell.data() + cell.size()) {
        const std::string column = row.size() < columns_.size() ? columns_[row.size()] : "beyond the header";
        throw app::FileError(name_ + ":" + std::to_string(lines_.line()) + ": column '" + column +
                             "': value '" + std::string(cell) + "', expected a number");
      }
    }
    row.push_back(value);
  });
  if (row.size() != columns_.size()) {
    throw app::FileError(name_ + ":" + std::to_string(lines_.line()) + ": " + std::to_string(row.size()) +
                         " cells, expected " + std::to_string(columns_.size()) + " as in the header");
  }
  return true;
}

}  // namespace patella::convert
