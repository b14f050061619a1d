// Conditions that the operator should know although they stop nothing.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>

namespace patella::safety {

/// Each value is a bit position in WarningSet. Append only: recorded logs carry the numbers.
enum class Warning : std::uint8_t {
  kNetworkFallback = 0,  ///< the observer compensates in place of the network, which it distrusts
  kClockStepped,         ///< the wall clock was set: stamps before and after do not compare
  kRecorderBehind,       ///< records were dropped, or the rings are nearly full
  kDiskLow,              ///< little room left where the recording goes
  kFileChanged,          ///< a file that the run was configured from is no longer as it was read
  kRecordingFailed,      ///< nothing more is written: the disk is full, or broken
  kCount
};

inline constexpr int kWarningCount = static_cast<int>(Warning::kCount);

/// snake_case name for logs and summaries.
constexpr std::string_view warningName(Warning warning) noexcept {
  constexpr std::array<std::string_view, kWarningCount> kNames = {
      "network_fallback", "clock_stepped", "recorder_behind", "disk_low", "file_changed", "recording_failed"};
  const auto index = static_cast<std::size_t>(warning);
  return index < kNames.size() ? kNames[index] : "unknown";
}

class WarningSet {
 public:
  constexpr WarningSet() noexcept = default;
  constexpr explicit WarningSet(std::uint32_t bits) noexcept : bits_(bits) {}
  constexpr void add(Warning warning) noexcept { bits_ |= mask(warning); }
  constexpr bool has(Warning warning) const noexcept { return (bits_ & mask(warning)) != 0; }
  constexpr bool any() const noexcept { return bits_ != 0; }
  constexpr std::uint32_t bits() const noexcept { return bits_; }
  constexpr WarningSet operator|(WarningSet other) const noexcept { return WarningSet(bits_ | other.bits_); }
  constexpr bool operator==(const WarningSet&) const noexcept = default;

 private:
  static constexpr std::uint32_t mask(Warning warning) noexcept {
    return 1U << static_cast<unsigned>(warning);
  }
  std::uint32_t bits_ = 0;
};

}  // namespace patella::safety
