// The loop's inputs, to which signals are bound: what each of them measures, and its timeout.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/can/unit.hpp"

namespace patella::can {

enum class Input : std::uint8_t {
  kPosition,
  kVelocity,
  kDriveTorque,
  kEmg,
  kTruth,
  kDriveEnabled,
  kDriveFault,
  kJointEnabled,
  kJointFault,
  kDriveTemperature,
  kDriveError,
  kOperatorEnable,
  kOperatorReset,
  kCount
};
inline constexpr auto kInputCount = static_cast<std::size_t>(Input::kCount);

/// Inputs that come and fail together; each has its timeout.
enum InputGroup : std::uint8_t {
  kEncoderGroup,
  kDriveGroup,
  kEmgGroup,
  kOperatorGroup,
  kNoTimeout,
  kInputGroupCount
};

struct InputKind {
  std::string_view name;
  InputGroup group;
  Dimension dimension;
  bool indexed;
  /// One signal may feed it and others, where the map says so: a drive may report in a single bit that it is
  /// enabled and without a fault. A measured quantity, a button or an electrode is never two of them.
  bool shareable;
};

inline constexpr std::array<InputKind, kInputCount> kInputKinds = {
    {{"position_rad", kEncoderGroup, Dimension::kAngle, true, false},
     {"velocity_rad_s", kEncoderGroup, Dimension::kRate, true, false},
     {"drive_torque_Nm", kDriveGroup, Dimension::kTorque, true, false},
     {"emg_mV", kEmgGroup, Dimension::kVoltage, true, false},
     {"true_f_u", kNoTimeout, Dimension::kAcceleration, true, false},
     {"drive_enabled", kDriveGroup, Dimension::kNone, false, true},
     {"drive_fault", kDriveGroup, Dimension::kNone, false, true},
     {"drive_enabled", kDriveGroup, Dimension::kNone, true, true},
     {"drive_fault", kDriveGroup, Dimension::kNone, true, true},
     {"drive_temperature_degC", kNoTimeout, Dimension::kTemperature, true, false},
     {"drive_error", kNoTimeout, Dimension::kNone, true, true},
     {"operator_enable", kOperatorGroup, Dimension::kNone, false, false},
     {"operator_reset", kOperatorGroup, Dimension::kNone, false, false}}};

struct InputId {
  Input input = Input::kPosition;
  std::size_t index = 0;  ///< from 0; names count from 1

  const InputKind& kind() const noexcept { return kInputKinds[static_cast<std::size_t>(input)]; }
  /// Its signal means well or ill, by a list of values where the map has one.
  bool judges() const noexcept {
    return input == Input::kDriveEnabled || input == Input::kDriveFault || input == Input::kJointEnabled ||
           input == Input::kJointFault;
  }
  bool operator==(const InputId&) const = default;
};

/// The input that a name such as "position_rad.2" means, for a leg of so many joints. A status without a
/// number is that of all drives, with one that of a joint's. Throws
/// std::invalid_argument naming it and what there is.
InputId inputOf(std::string_view name, int joints);

}  // namespace patella::can
