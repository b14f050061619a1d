#include "drivers/files/line_reader.hpp"

#include <algorithm>
#include <stdexcept>

namespace patella::files {
namespace {

constexpr std::size_t kBlockBytes = 1 << 16;

}  // namespace

LineReader::LineReader(const std::filesystem::path& path, std::size_t longest)
    : file_(path), longest_(longest), block_(kBlockBytes) {}

bool LineReader::fill() {
  begin_ = 0;
  end_ = file_.read(block_);
  return end_ != 0;
}

bool LineReader::next(std::string& line) {
  line.clear();
  if (begin_ == end_ && !fill())
    return false;
  ++line_;
  do {
    const char* const first = block_.data() + begin_;
    const char* const last = block_.data() + end_;
    const char* const feed = std::find(first, last, '\n');
    if (line.size() + static_cast<std::size_t>(feed - first) > longest_) {
      throw std::runtime_error(file_.name() + ":" + std::to_string(line_) +
                               ": the line is too long, expected at most " + std::to_string(longest_) +
                               " bytes");
    }
    line.append(first, feed);
    begin_ += static_cast<std::size_t>(feed - first);
    if (feed != last) {
      ++begin_;
      return true;
    }
  } while (fill());
  unterminated_ = true;
  return true;
}

}  // namespace patella::files
