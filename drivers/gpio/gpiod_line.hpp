// One requested GPIO line: all that the project asks of libgpiod, implemented for its versions 1 and 2.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "core/types.hpp"

namespace patella::gpio {

enum class Bias : std::uint8_t {
  kAsIs,  ///< resistors on the board decide
  kPullUp,
  kPullDown,
};

class GpiodLine {
 public:
  /// Input with edge detection in both directions. Throws std::runtime_error naming chip, line and reason.
  static GpiodLine requestInput(const std::string& chip_path, int offset, bool active_low, Bias bias);
  /// Push-pull output, initially low. Throws std::runtime_error naming chip, line and reason.
  static GpiodLine requestOutput(const std::string& chip_path, int offset);

  /// 1 active, 0 inactive, -1 when the device refused.
  int level() noexcept PATELLA_NONBLOCKING;
  /// Number of edges since the last call (the kernel keeps at least 16), -1 when the device refused.
  int takeEdges() noexcept PATELLA_NONBLOCKING;
  /// False when the device refused.
  bool set(bool level) noexcept PATELLA_NONBLOCKING;

 private:
  struct Handle;
  struct Release {
    void operator()(Handle* handle) const noexcept;
  };

  explicit GpiodLine(std::unique_ptr<Handle, Release> handle) noexcept : handle_(std::move(handle)) {}

  std::unique_ptr<Handle, Release> handle_;
};

}  // namespace patella::gpio
