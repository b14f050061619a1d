#include "firmware_app/files/toml_shape.hpp"

#include <algorithm>

#include "firmware_app/files/file_error.hpp"

namespace patella::app {
namespace {

/// One pass that knows strings and comments, so that what they hold does not count, and what a parser would
/// see outside of them always does: a string that is not closed ends where the parser gives up.
class ShapeScan {
 public:
  ShapeScan(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  void run() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        skipString(c);
      } else if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        take(c);
        ++at_;
      }
    }
  }

 private:
  void take(char c) {
    switch (c) {
      case '[':
      case '{':
        bound(++depth_, kDeepestToml, "brackets within brackets");
        item();
        break;
      case ']':
      case '}':
        depth_ = std::max(depth_ - 1, 0);
        parts_ = 1;
        break;
      case '.':
        bound(++parts_, kMostTomlParts, "parts of a dotted key");
        break;
      case ',':
      case '=':
        item();
        break;
      case '\n':
        parts_ = 1;
        break;
      default:
        break;
    }
  }

  void item() {
    parts_ = 1;
    bound(++items_, kMostTomlItems, "keys and elements");
  }

  void skipString(char quote) {
    const std::string three(3, quote);
    if (!text_.substr(at_).starts_with(three)) {
      skipLine(quote);
      return;
    }
    at_ += three.size();
    while (at_ < text_.size() && !text_.substr(at_).starts_with(three))
      at_ += quote == '"' && text_[at_] == '\\' ? 2 : 1;
    at_ = std::min(at_ + three.size(), text_.size());
    // Up to two quotes before the three that close belong to the string.
    for (int i = 0; i < 2 && at_ < text_.size() && text_[at_] == quote; ++i)
      ++at_;
  }

  /// A string of one line, which ends with the line at the latest.
  void skipLine(char quote) {
    for (++at_; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
      if (text_[at_] == quote) {
        ++at_;
        return;
      }
      const bool escapes = quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size();
      at_ += escapes && text_[at_ + 1] != '\n' ? 1 : 0;
    }
  }

  void bound(int count, int most, const char* of) const {
    if (count > most) {
      const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
      throw FileError(name_ + ":" + std::to_string(line) + ": more than " + std::to_string(most) + " " + of +
                      ", expected at most " + std::to_string(most));
    }
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  int depth_ = 0;
  int parts_ = 1;
  int items_ = 0;
};

}  // namespace

void checkTomlShape(std::string_view text, const std::string& name) {
  ShapeScan(text, name).run();
}

}  // namespace patella::app
