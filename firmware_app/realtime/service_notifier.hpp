// Tells the service manager that the service is ready, alive, or stopping. See sd_notify(3);
// the protocol is a datagram to the socket that NOTIFY_SOCKET names.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace patella::app {

class ServiceNotifier {
 public:
  /// Without NOTIFY_SOCKET in the environment nothing is sent.
  ServiceNotifier();
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// Sends a state such as "READY=1". False where nobody listens; never waits.
  bool notify(std::string_view state) const noexcept;

  /// Half of WatchdogSec, as the manager has put it into WATCHDOG_USEC; empty where it does not watch this
  /// process.
  static std::optional<std::chrono::microseconds> watchdogInterval();

 private:
  int socket_ = -1;
  std::string path_;
};

}  // namespace patella::app
