// Windows-1252 to UTF-8, for files whose editors never said which they write.
#pragma once

#include <string>
#include <string_view>

namespace patella::can {

/// The text itself where it is valid UTF-8 (a byte-order mark is dropped), else its bytes as Windows-1252.
std::string toUtf8(std::string_view text);

}  // namespace patella::can
