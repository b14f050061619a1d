// Recordings that a test looks at as one text.
#pragma once

#include "drivers/files/regular_file.hpp"

namespace patella::test {

inline constexpr files::FileKind kRecordingText{"a recording", 4'000'000'000};

}  // namespace patella::test
