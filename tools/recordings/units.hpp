// Units in which the signals of a file may stand.
#pragma once

#include <span>

namespace patella::diagnose {

enum class Quantity { kTime, kPosition, kVelocity, kTorque, kEmg, kActivation };

struct Unit {
  const char* name;  ///< as maps have it
  double factor;     ///< s, rad (m), rad/s (m/s), N·m (N), mV or share of the maximum, per unit
};

/// Units of a quantity, the one that the recording itself has first.
std::span<const Unit> unitsOf(Quantity quantity) noexcept;

}  // namespace patella::diagnose
