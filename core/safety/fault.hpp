// The causes for which the loop stops torque, as numbers that logs, summaries and tests share.
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace patella::safety {

/// Each value is a bit position in FaultSet. Append only: recorded logs carry the numbers.
enum class Fault : std::uint8_t {
  kEmergencyStop = 0,    ///< line asserted, or its device unreadable
  kEncoderStale,         ///< no valid encoder sample within the timeout
  kEncoderImplausible,   ///< position or velocity out of the sensor's range, or a jump no leg can make
  kDriveStale,           ///< no valid drive status within the timeout
  kDriveFault,           ///< the drive reports a fault of its own
  kEmgStale,             ///< no valid EMG frame within the timeout
  kFrameCorrupt,         ///< CRC failures beyond the tolerated count
  kFrameSequence,        ///< counter repeats or jumps beyond the tolerated count
  kBusOff,               ///< controller left the bus, or the interface is down
  kSendFailed,           ///< commands could not be queued, in a row or too often
  kOverrun,              ///< ticks ended late, in a row or too often, or one by far
  kNotFinite,            ///< NaN or infinity in an estimate or a command
  kVelocityLimit,        ///< joint faster than allowed
  kJointRange,           ///< joint outside its allowed range
  kTorqueLimit,          ///< demand above the torque limit for longer than tolerated
  kEncoderInconsistent,  ///< position and rate tell of different motions
  kModelMismatch,        ///< more torque acts than any patient has: model, encoder or drive is wrong
  kFollowingError,       ///< the leg is not where the reference holds it
  kDriveNotFollowing,    ///< drive feedback does not match what was commanded
  kDriveOverTorque,      ///< drive feedback above the torque limit
  kEmgElectrodeOff,      ///< an electrode that assistance needs stands still
  kEmgSaturated,         ///< likewise, at the end of its range
  kEmgHum,               ///< likewise, drowned by the mains
  kWatchdog,             ///< the watchdog thread found the loop standing still
  kForeignCommand,       ///< somebody else commands the drives
  kCommandLate,          ///< the measurement was too old by the time its command could be sent
  kDriveNotEntered,      ///< a drive did not report enabled within the time for it
  kDriveLeft,            ///< a drive that was enabled no longer is, and nobody told it so
  kDriveEmergency,       ///< a CANopen drive sent an emergency
  kDriveOffline,         ///< a CANopen drive's heartbeat is missing, or it is not what the set-up made of it
  kFrameImplausible,  ///< a drive's or electrodes' values out of their declared ranges beyond the tolerated
                      ///< count
  kLineRefused,       ///< an output line did not take its level
  kCount
};

inline constexpr int kFaultCount = static_cast<int>(Fault::kCount);
static_assert(kFaultCount <= 32, "FaultSet, records and messages have 32 bits");

/// snake_case name for logs and summaries.
std::string_view faultName(Fault fault) noexcept;

class FaultSet {
 public:
  constexpr FaultSet() noexcept = default;
  constexpr explicit FaultSet(std::uint32_t bits) noexcept : bits_(bits) {}
  constexpr FaultSet(std::initializer_list<Fault> faults) noexcept {
    for (const Fault fault : faults) {
      add(fault);
    }
  }

  constexpr void add(Fault fault) noexcept { bits_ |= mask(fault); }
  constexpr bool has(Fault fault) const noexcept { return (bits_ & mask(fault)) != 0; }
  constexpr bool any() const noexcept { return bits_ != 0; }
  constexpr std::uint32_t bits() const noexcept { return bits_; }
  /// Fault of the lowest number; Fault::kCount when there is none.
  constexpr Fault first() const noexcept {
    return any() ? static_cast<Fault>(std::countr_zero(bits_)) : Fault::kCount;
  }
  constexpr FaultSet operator|(FaultSet other) const noexcept { return FaultSet(bits_ | other.bits_); }
  constexpr FaultSet operator&(FaultSet other) const noexcept { return FaultSet(bits_ & other.bits_); }
  constexpr FaultSet without(FaultSet other) const noexcept { return FaultSet(bits_ & ~other.bits_); }
  constexpr bool operator==(const FaultSet&) const noexcept = default;

 private:
  static constexpr std::uint32_t mask(Fault fault) noexcept { return 1U << static_cast<unsigned>(fault); }
  std::uint32_t bits_ = 0;
};

}  // namespace patella::safety
