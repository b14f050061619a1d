// Little-endian numbers, strings and maps as MCAP's records have them: unaligned, lengths of 32 bits.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace patella::formats {

template <typename Number>
void appendNumber(std::string& out, Number value) {
  static_assert(std::is_integral_v<Number>);
  out.append(reinterpret_cast<const char*>(&value), sizeof(Number));
}

inline void appendText(std::string& out, std::string_view text) {
  appendNumber(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}

inline void appendMap(std::string& out, const std::map<std::string, std::string>& map) {
  std::string pairs;
  for (const auto& [key, value] : map) {
    appendText(pairs, key);
    appendText(pairs, value);
  }
  appendText(out, pairs);
}

/// Takes a record's content apart. Throws std::invalid_argument where it ends too soon.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) noexcept : bytes_(bytes) {}

  template <typename Number>
  Number number() {
    static_assert(std::is_integral_v<Number>);
    Number value;
    std::memcpy(&value, take(sizeof(Number)).data(), sizeof(Number));
    return value;
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::map<std::string, std::string> map() {
    ByteReader pairs(text());
    std::map<std::string, std::string> values;
    while (!pairs.rest().empty()) {
      std::string key(pairs.text());
      values[std::move(key)] = std::string(pairs.text());
    }
    return values;
  }
  std::string_view take(std::uint64_t length) {
    if (length > bytes_.size()) {
      throw std::invalid_argument("a record ends before its last field");
    }
    const std::string_view taken = bytes_.substr(0, static_cast<std::size_t>(length));
    bytes_.remove_prefix(static_cast<std::size_t>(length));
    return taken;
  }
  std::string_view rest() const noexcept { return bytes_; }

 private:
  std::string_view bytes_;
};

}  // namespace patella::formats
