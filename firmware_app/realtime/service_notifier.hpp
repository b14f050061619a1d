// What a service manager is told: that the program is ready, alive, or about to end. Protocol: sd_notify(3).
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace patella::app {

/// Sends datagrams to the socket that the manager names in NOTIFY_SOCKET; silent where it names none. Not for
/// the loop's thread.
class ServiceNotifier {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  /// Reads NOTIFY_SOCKET and WATCHDOG_USEC. Throws std::invalid_argument for a socket path too long to be
  /// one.
  ServiceNotifier();
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// `progress` counts what the loop has done. The first tick makes the service ready; from then on the
  /// watchdog is fed at half its period, but only while the count goes up: a loop that stands still lets it
  /// expire.
  void progress(std::uint64_t count, Instant now);
  void stopping();

 private:
  void send(std::string_view message) const;

  std::string address_;  ///< as bind(2) takes it; empty: nobody listens
  int socket_ = -1;
  std::chrono::microseconds feed_period_{0};  ///< zero: no watchdog
  std::uint64_t fed_count_ = 0;
  Instant fed_at_{};
  bool ready_ = false;
};

}  // namespace patella::app
