// How much of each thing a bus description may hold. Checks compare every signal of a message with every
// other, so a file of a few megabytes could otherwise take hours; no description in use comes near these.
#pragma once

#include <cstddef>

namespace patella::can {

inline constexpr std::size_t kMostDbcMessages = 20'000;
inline constexpr std::size_t kMostDbcSignals = 100'000;           ///< of all messages
inline constexpr std::size_t kMostDbcMessageSignals = 1'024;      ///< of one
inline constexpr std::size_t kMostDbcIndependentSignals = 4'096;  ///< that no message uses
inline constexpr std::size_t kMostDbcRanges = 20'000;             ///< of multiplexors, of all signals
inline constexpr std::size_t kDeepestDbcCascade = 8;              ///< multiplexors that select one another
inline constexpr std::size_t kMostDbcSenders = 256;               ///< of one message
inline constexpr std::size_t kMostDbcEnumeration = 1'000;         ///< values of one attribute

}  // namespace patella::can
