// Units as DBC files write them, and what they are in the loop's own.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace patella::can {

/// Quantity of a number. kNone is for flags and states; kOther for inputs without a unit in the loop.
enum class Dimension : std::uint8_t {
  kAngle,
  kRate,
  kAcceleration,
  kTorque,
  kVoltage,
  kTemperature,
  kNone,
  kOther
};

/// The loop's own unit: rad, rad/s, rad/s², N·m, mV, °C; empty for kNone and kOther.
std::string_view unitName(Dimension dimension) noexcept;

struct Unit {
  Dimension dimension = Dimension::kOther;
  double factor = 1.0;  ///< the loop's own units in one of these
};

/// The unit that a text such as "deg", "mN.m" or "µV" means; none where it is not known. Metres and newtons
/// are not known on purpose: a prismatic joint measures its "angle" and "torque" in them.
std::optional<Unit> findUnit(std::string_view text);

}  // namespace patella::can
