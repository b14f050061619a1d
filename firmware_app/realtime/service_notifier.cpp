#include "firmware_app/realtime/service_notifier.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace patella::app {

ServiceNotifier::ServiceNotifier() {
  const char* const address = std::getenv("NOTIFY_SOCKET");  // NOLINT(concurrency-mt-unsafe): set-up, once
  const char* const watchdog_us =
      std::getenv("WATCHDOG_USEC");  // NOLINT(concurrency-mt-unsafe): set-up, once
  if (address == nullptr || (address[0] != '/' && address[0] != '@')) {
    return;
  }
  address_ = address;
  if (address_.size() >= sizeof(sockaddr_un::sun_path)) {
    throw std::invalid_argument("NOTIFY_SOCKET is " + std::to_string(address_.size()) +
                                " characters long, expected a socket's path");
  }
  if (address_[0] == '@') {
    address_[0] = '\0';  // a name in the abstract namespace
  }
  socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (watchdog_us != nullptr) {
    feed_period_ = std::chrono::microseconds(std::strtoll(watchdog_us, nullptr, 10) / 2);
  }
}

ServiceNotifier::~ServiceNotifier() {
  if (socket_ >= 0) {
    close(socket_);
  }
}

void ServiceNotifier::progress(std::uint64_t count, Instant now) {
  if (count == fed_count_) {
    return;
  }
  if (!ready_) {
    ready_ = true;
    send("READY=1");
  } else if (feed_period_.count() <= 0 || now - fed_at_ < feed_period_) {
    return;
  }
  fed_count_ = count;
  fed_at_ = now;
  if (feed_period_.count() > 0) {
    send("WATCHDOG=1");
  }
}

void ServiceNotifier::stopping() {
  send("STOPPING=1");
}

void ServiceNotifier::send(std::string_view message) const {
  if (socket_ < 0) {
    return;
  }
  sockaddr_un target{};
  target.sun_family = AF_UNIX;
  std::copy(address_.begin(), address_.end(), target.sun_path);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  // A manager that does not listen is no reason to stop.
  static_cast<void>(sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL,
                           reinterpret_cast<const sockaddr*>(&target), size));
}

}  // namespace patella::app
