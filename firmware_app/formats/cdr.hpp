// Common Data Representation as ROS 2 has it (OMG CORBA 3.4, 9.3, "plain CDR", little-endian): every number
// stands at a multiple of its size, counted from behind the four bytes of the encapsulation header.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace patella::formats {

static_assert(std::endian::native == std::endian::little, "bytes are copied as they stand in memory");

class CdrWriter {
 public:
  CdrWriter() { clear(); }

  /// Begins the next message; the buffer keeps its memory.
  void clear() { bytes_.assign(kHeader); }

  template <typename Number>
  void put(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    align(sizeof(Number));
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Number));
  }
  void boolean(bool value) { put<std::uint8_t>(value ? 1 : 0); }
  /// Its length and its zero at the end included.
  void text(std::string_view value) {
    put(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value);
    bytes_.push_back('\0');
  }
  /// Length of a sequence, whose elements follow.
  void length(std::size_t count) { put(static_cast<std::uint32_t>(count)); }
  /// Bytes of a fixed array or of a sequence whose length has been written.
  void raw(std::string_view bytes) { bytes_.append(bytes); }
  /// builtin_interfaces/Time.
  void time(std::uint64_t since_1970_ns) {
    constexpr std::uint64_t kSecond = 1'000'000'000;
    put(static_cast<std::int32_t>(since_1970_ns / kSecond));
    put(static_cast<std::uint32_t>(since_1970_ns % kSecond));
  }

  std::string_view bytes() const noexcept { return bytes_; }

 private:
  static constexpr std::string_view kHeader{"\0\1\0\0", 4};  // plain CDR, little-endian

  void align(std::size_t size) {
    const std::size_t beyond = (bytes_.size() - kHeader.size()) % size;
    bytes_.append(beyond == 0 ? 0 : size - beyond, '\0');
  }

  std::string bytes_;
};

class CdrReader {
 public:
  /// Reads from `bytes`, which must outlive it. Throws std::invalid_argument where they do not begin as
  /// little-endian plain CDR does.
  explicit CdrReader(std::string_view bytes) : bytes_(bytes) {
    if (bytes.size() < kHeaderSize || bytes[0] != '\0' || bytes[1] != '\1') {
      throw std::invalid_argument(
          "a message does not begin with 00 01 00 00, expected little-endian plain CDR");
    }
  }

  /// Throws std::invalid_argument where the message ends before.
  template <typename Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    const std::size_t beyond = (at_ - kHeaderSize) % sizeof(Number);
    at_ += beyond == 0 ? 0 : sizeof(Number) - beyond;
    if (at_ > bytes_.size() || bytes_.size() - at_ < sizeof(Number)) {
      throw std::invalid_argument("a message of " + std::to_string(bytes_.size()) +
                                  " bytes ends before its last field");
    }
    Number value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(Number));
    at_ += sizeof(Number);
    return value;
  }

 private:
  static constexpr std::size_t kHeaderSize = 4;

  std::string_view bytes_;
  std::size_t at_ = kHeaderSize;
};

}  // namespace patella::formats
