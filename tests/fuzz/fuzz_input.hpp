// Parts that the targets share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

namespace patella::fuzz {

inline std::string_view text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Repeats parts, which chance would take years to write: byte 1, the part, its count as a power of two.
/// Every other byte stands for itself.
inline std::string expanded(std::string_view input) {
  constexpr std::array<std::string_view, 6> kParts = {"[", "{ a = ", ".a", "1,", "\n[a]\n", "\"\"\""};
  constexpr std::size_t kLongest = 2'000'000;
  std::string result;
  for (std::size_t i = 0; i < input.size() && result.size() < kLongest; ++i) {
    if (input[i] != '\x01' || i + 2 >= input.size()) {
      result += input[i];
      continue;
    }
    const std::string_view part = kParts[static_cast<unsigned char>(input[i + 1]) % kParts.size()];
    const std::size_t times = std::size_t{1} << (static_cast<unsigned char>(input[i + 2]) % 18U);
    for (std::size_t n = 0; n < times && result.size() < kLongest; ++n)
      result += part;
    i += 2;
  }
  return result;
}

/// Ends the program where a statement does not hold, so that the input is kept.
inline void require(bool holds, const char* statement) {
  if (!holds) {
    std::fprintf(stderr, "does not hold: %s\n", statement);
    std::abort();
  }
}

/// A file in memory, for readers that take a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
    require(descriptor_ >= 0, "a file in memory");
    std::size_t written = 0;
    while (written < bytes.size()) {
      const ssize_t now = write(descriptor_, bytes.data() + written, bytes.size() - written);
      require(now > 0, "write to memory");
      written += static_cast<std::size_t>(now);
    }
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace patella::fuzz
