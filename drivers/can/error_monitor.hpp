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

class ErrorMonitor {
 public:
  /// Called before the frames of a tick are taken.
  void beginReceive() noexcept { reported_ = false; }

  /// Takes every frame received, error report or not. A data frame from another node proves the bus alive.
  void observe(const Frame& frame, BusStatistics& statistics) noexcept {
    if (frame.own)
      return;  // not from another node, nor from the controller
    if (!frame.error) {
      bus_off_ = false;
      return;
    }
    constexpr unsigned kPassive = 0x30;  // CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE
    ++statistics.error_frames;
    if ((frame.id & kErrorController) != 0 && (frame.data[1] & kPassive) != 0)
      ++statistics.error_passive;
    if ((frame.id & kErrorBusOff) != 0) {
      ++statistics.bus_off;
      bus_off_ = true;
      reported_ = true;
    }
    if ((frame.id & kErrorRestarted) != 0)
      bus_off_ = false;
  }

  bool busOff() const noexcept { return bus_off_; }
  /// Off now, or at any time since beginReceive(): what was queued when the controller left the bus is lost,
  /// even if other nodes are heard again within the same tick.
  bool wasOff() const noexcept { return bus_off_ || reported_; }

 private:
  bool bus_off_ = false;
  bool reported_ = false;
};

}  // namespace patella::can
