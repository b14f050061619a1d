// The check sum of MCAP files.
#pragma once

#include <cstdint>
#include <string_view>

#include <zlib.h>

namespace patella::formats {

/// CRC-32 of bytes, which may come in parts: `before` is that of what precedes them.
inline std::uint32_t mcapCrc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace patella::formats
