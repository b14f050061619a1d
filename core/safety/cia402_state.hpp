// The states of a drive after CiA 402 (IEC 61800-7-201), and the word that leads from each to where the loop
// wants it: pure functions.
#pragma once

#include <array>
#include <cstdint>

namespace patella::safety {

enum class Cia402State : std::uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReady,  ///< to switch on
  kSwitchedOn,
  kOperationEnabled,  ///< the only one with torque
  kQuickStop,
  kFaultReaction,
  kFault,
  kUndefined,  ///< bits that no state has
  kCount
};
inline constexpr int kCia402StateCount = static_cast<int>(Cia402State::kCount);

/// What a status word (6041h) says with the bits that tell the state.
struct Cia402Pattern {
  std::uint16_t mask;
  std::uint16_t value;
  Cia402State state;
};

/// No word matches two of them.
inline constexpr std::array kCia402Patterns{
    Cia402Pattern{0x4F, 0x00, Cia402State::kNotReady},
    Cia402Pattern{0x4F, 0x40, Cia402State::kSwitchOnDisabled},
    Cia402Pattern{0x6F, 0x21, Cia402State::kReady},
    Cia402Pattern{0x6F, 0x23, Cia402State::kSwitchedOn},
    Cia402Pattern{0x6F, 0x27, Cia402State::kOperationEnabled},
    Cia402Pattern{0x6F, 0x07, Cia402State::kQuickStop},
    Cia402Pattern{0x4F, 0x0F, Cia402State::kFaultReaction},
    Cia402Pattern{0x4F, 0x08, Cia402State::kFault},
};

/// Bits of the status word that tell operation enabled, and what they hold then.
inline constexpr std::uint16_t kCia402EnabledMask = 0x6F;
inline constexpr std::uint16_t kCia402EnabledValue = 0x27;
/// Set in the fault and on the way there, and in no other state.
inline constexpr std::uint16_t kCia402FaultMask = 0x08;

constexpr Cia402State cia402State(std::uint16_t status_word) noexcept {
  for (const Cia402Pattern& pattern : kCia402Patterns) {
    if ((status_word & pattern.mask) == pattern.value) {
      return pattern.state;
    }
  }
  return Cia402State::kUndefined;
}

/// Controlword (6040h) of one tick. `reset` clears a fault by its edge, so it has to be there for one tick
/// only. A state without a way to torque gets "disable voltage", which every drive obeys from anywhere.
constexpr std::uint16_t cia402Controlword(Cia402State state, bool enable, bool reset) noexcept {
  constexpr std::uint16_t kDisableVoltage = 0x00;
  constexpr std::uint16_t kShutdown = 0x06;
  constexpr std::uint16_t kSwitchOn = 0x07;
  constexpr std::uint16_t kEnableOperation = 0x0F;
  constexpr std::uint16_t kFaultReset = 0x80;
  switch (state) {
    case Cia402State::kSwitchOnDisabled:
      return kShutdown;
    case Cia402State::kReady:
      return enable ? kSwitchOn : kShutdown;
    case Cia402State::kSwitchedOn:
    case Cia402State::kOperationEnabled:
      return enable ? kEnableOperation : kShutdown;
    case Cia402State::kFault:
      return reset ? kFaultReset : kDisableVoltage;
    default:
      return kDisableVoltage;
  }
}

}  // namespace patella::safety
