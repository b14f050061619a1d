// State of a CAN network interface, asked of the kernel over rtnetlink(7).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace patella::app {

struct CanInterface {
  bool up = false;
  bool can = false;                    ///< carries CAN frames (ARPHRD_CAN)
  std::string kind;                    ///< "can", "vcan", …; empty for a device without a kind
  bool fd = false;                     ///< takes CAN FD frames
  std::uint32_t bitrate = 0;           ///< bit/s; 0 where there is none, as on vcan
  std::uint32_t txqueuelen = 0;        ///< frames
  std::uint32_t restart_ms = 0;        ///< from bus-off back to the bus, ms; 0: not by itself
  std::optional<std::uint32_t> state;  ///< can_state of linux/can/netlink.h, where there is a controller
};

/// Nothing when there is no such interface. Throws std::runtime_error when the kernel cannot be asked.
std::optional<CanInterface> queryCanInterface(const std::string& name);

/// Brings the interface up or takes it down; needs CAP_NET_ADMIN. Throws std::runtime_error naming the
/// interface and the system's reason.
void setCanInterfaceUp(const std::string& name, bool up);

/// Throws std::invalid_argument unless the interface is a vcan, which no motor hears.
void requireVirtual(const std::string& name);

/// True when the kernel has raw CAN sockets.
bool kernelHasCan() noexcept;

}  // namespace patella::app
