// Which stream of the rig's seed each source of randomness draws from.
#pragma once

#include <cstdint>

namespace patella::sim {

inline constexpr std::uint64_t kInteractionStream = 1;
inline constexpr std::uint64_t kDriveStream = 2;
inline constexpr std::uint64_t kFaultStream = 3;
inline constexpr std::uint64_t kEncoderStream = 16;  ///< + joint
inline constexpr std::uint64_t kEmgStream = 32;      ///< + channel

}  // namespace patella::sim
