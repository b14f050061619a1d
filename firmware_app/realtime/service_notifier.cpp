#include "firmware_app/realtime/service_notifier.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace patella::app {

ServiceNotifier::ServiceNotifier() {
  const char* path = std::getenv("NOTIFY_SOCKET");  // NOLINT(concurrency-mt-unsafe): set-up, once
  if (path != nullptr && (path[0] == '/' || path[0] == '@')) {
    path_ = path;
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  }
}

ServiceNotifier::~ServiceNotifier() {
  if (socket_ >= 0) {
    close(socket_);
  }
}

bool ServiceNotifier::notify(std::string_view state) const noexcept {
  sockaddr_un address{};
  if (socket_ < 0 || path_.size() >= sizeof address.sun_path) {
    return false;
  }
  address.sun_family = AF_UNIX;
  std::copy(path_.begin(), path_.end(), address.sun_path);
  if (path_.front() == '@') {
    address.sun_path[0] = '\0';  // the abstract namespace
  }
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path_.size());
  const ssize_t sent = sendto(socket_, state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                              reinterpret_cast<const sockaddr*>(&address), length);
  return sent == static_cast<ssize_t>(state.size());
}

std::optional<std::chrono::microseconds> ServiceNotifier::watchdogInterval() {
  const auto number = [](const char* name) -> std::optional<long long> {
    const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): set-up, once
    if (text == nullptr) {
      return std::nullopt;
    }
    const std::string_view digits(text);
    long long value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() ? std::optional(value) : std::nullopt;
  };
  const auto process = number("WATCHDOG_PID");
  const auto period_us = number("WATCHDOG_USEC");
  if (!period_us || *period_us <= 0 || (process && *process != getpid())) {
    return std::nullopt;
  }
  return std::chrono::microseconds(*period_us / 2);
}

}  // namespace patella::app
