// Is this machine fit to run the loop? Looks only; changes nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_app/realtime/can_interface.hpp"
#include "firmware_app/realtime/finding.hpp"
#include "firmware_app/realtime/host_files.hpp"

namespace patella::app {

struct CanNeed {
  std::string interface;
  std::uint32_t bitrate = 0;  ///< bit/s expected on it; 0: any
  std::string fd_message{};   ///< one that needs CAN FD; empty: none does
};

struct HostNeeds {
  int priority = 80;         ///< SCHED_FIFO priority that the loop will ask for
  std::vector<int> cpus;     ///< processors that the loop will be bound to; empty: any
  std::vector<CanNeed> can;  ///< interfaces that the loop will use
  std::string gpio_chip;     ///< device path; empty: none needed
};

/// One finding per condition, always in the same order; those of several CAN interfaces begin with its name.
std::vector<Finding> hostReadiness(const HostNeeds& needs, const HostFiles& host = HostFiles());

/// Those of one CAN interface; nothing: there is no such interface.
std::vector<Finding> interfaceFindings(const CanNeed& need, const std::optional<CanInterface>& interface);

/// A longer queue holds torque commands back and lets them go after a stop; the kernel's own default.
inline constexpr std::uint32_t kLongestCanQueue = 10;

}  // namespace patella::app
