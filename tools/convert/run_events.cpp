#include "tools/convert/run_events.hpp"

#include <charconv>

#include "firmware_app/files/file_error.hpp"

namespace patella::convert {
namespace {

constexpr std::size_t kLongestEvent = 10'000;

}  // namespace

RunEvents::RunEvents(const std::filesystem::path& file) : name_(file.string()) {
  if (std::filesystem::exists(file)) {
    lines_.emplace(file, kLongestEvent);
    advance();
  }
}

void RunEvents::advance() {
  constexpr std::string_view kTime = "t_s=";
  do {
    more_ = lines_->next(line_) && !lines_->unterminated();
  } while (more_ && !line_.starts_with(kTime));
  if (more_ &&
      std::from_chars(line_.data() + kTime.size(), line_.data() + line_.size(), time_s_).ec != std::errc()) {
    throw app::FileError(name_ + ":" + std::to_string(lines_->line()) + ": value '" + line_ +
                         "', expected t_s= and a time");
  }
}

}  // namespace patella::convert
