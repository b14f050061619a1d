// State of the bus from the controller's error reports. Layout: linux/can/error.h.
#pragma once

#include <cstdint>

#include "drivers/can/bus.hpp"
#include "drivers/can/can_frame.hpp"

namespace patella::can {

inline constexpr std::uint32_t kErrorTxTimeout = 0x001;   ///< CAN_ERR_TX_TIMEOUT
inline constexpr std::uint32_t kErrorController = 0x004;  ///< CAN_ERR_CRTL, detail in data[1]
inline constexpr std::uint32_t kErrorBusOff = 0x040;      ///< CAN_ERR_BUSOFF
inline constexpr std::uint32_t kErrorRestarted = 0x100;   ///< CAN_ERR_RESTARTED
/// Reports worth having; lost arbitration is everyday life on a bus and is left out.
inline constexpr std::uint32_t kErrorsOfInterest =
    kErrorTxTimeout | kErrorController | kErrorBusOff | kErrorRestarted;

/// Of all buses, which frames name.
class ErrorMonitor {
 public:
  /// Called before the frames of a tick are taken.
  void beginReceive() noexcept { reported_ = 0; }

  /// Takes every frame received, error report or not. A data frame from another node proves the bus alive.
  void observe(const Frame& frame, BusStatistics& statistics) noexcept {
    if (frame.own)
      return;  // not from another node, nor from the controller
    const BusSet bit = busBit(frame.bus);
    if (!frame.error) {
      bus_off_ = static_cast<BusSet>(bus_off_ & ~bit);
      return;
    }
    constexpr unsigned kPassive = 0x30;  // CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE
    ++statistics.error_frames;
    if ((frame.id & kErrorController) != 0 && (frame.data[1] & kPassive) != 0)
      ++statistics.error_passive;
    if ((frame.id & kErrorBusOff) != 0) {
      ++statistics.bus_off;
      bus_off_ = static_cast<BusSet>(bus_off_ | bit);
      reported_ = static_cast<BusSet>(reported_ | bit);
    }
    if ((frame.id & kErrorRestarted) != 0)
      bus_off_ = static_cast<BusSet>(bus_off_ & ~bit);
  }

  bool busOff() const noexcept { return bus_off_ != 0; }
  /// Off now, or at any time since beginReceive(): what was queued when the controller left the bus is lost,
  /// even if other nodes are heard again within the same tick.
  BusSet wasOff() const noexcept { return static_cast<BusSet>(bus_off_ | reported_); }

 private:
  BusSet bus_off_ = 0;
  BusSet reported_ = 0;
};

}  // namespace patella::can
