// The thread that watches the loop, and what it tells the service manager.
#include "firmware_app/realtime/watchdog.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

using namespace patella;
using namespace patella::app;

namespace {

/// Waits for what another thread does; the limit only ends a test that has failed.
template <typename Condition>
bool comes(Condition&& condition) {
  for (int i = 0; i < 2000 && !condition(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

/// A datagram socket of the kind that systemd listens at, in the abstract namespace.
class Manager {
 public:
  Manager() : name_("@patella-test-" + std::to_string(getpid())) {
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name_.copy(address.sun_path, sizeof address.sun_path);
    address.sun_path[0] = '\0';
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
    REQUIRE(bind(socket_, reinterpret_cast<sockaddr*>(&address), length) == 0);
    setenv("NOTIFY_SOCKET", name_.c_str(), 1);
  }
  ~Manager() {
    unsetenv("NOTIFY_SOCKET");
    close(socket_);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// Everything heard so far.
  const std::vector<std::string>& heard() {
    std::array<char, 256> text{};
    ssize_t length = 0;
    while ((length = recv(socket_, text.data(), text.size(), MSG_DONTWAIT)) > 0) {
      heard_.emplace_back(text.data(), static_cast<std::size_t>(length));
    }
    return heard_;
  }
  bool heard(const std::string& state) {
    heard();
    return std::find(heard_.begin(), heard_.end(), state) != heard_.end();
  }

 private:
  std::string name_;
  int socket_ = -1;
  std::vector<std::string> heard_;
};

}  // namespace

TEST_CASE("a loop that stands still loses the enable line, once, and learns of it") {
  gpio::SimulatedPins pins;
  Watchdog watchdog({.timeout_s = 0.05}, pins);
  pins.setDriveEnable(true);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(pins.driveEnable());  // nobody has begun
  CHECK(watchdog.trips() == 0);
  watchdog.beat();
  CHECK(comes([&] { return !pins.driveEnable(); }));
  CHECK(comes([&] { return watchdog.trips() == 1; }));
  CHECK(watchdog.takeTrip());
  CHECK_FALSE(watchdog.takeTrip());
  pins.setDriveEnable(true);  // by a loop that stood still just before it did so
  CHECK(comes([&] { return !pins.driveEnable(); }));
  const std::uint64_t edges = pins.watchdogEdges();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(watchdog.trips() == 1);
  CHECK(pins.watchdogEdges() == edges);  // its heartbeat stands still with the loop's
  watchdog.beat();
  CHECK(comes([&] { return watchdog.trips() == 2; }));
}

TEST_CASE("the heartbeat of the watchdog goes on for as long as the loop's does") {
  gpio::SimulatedPins pins;
  Watchdog watchdog({.timeout_s = 0.5}, pins);
  CHECK(comes([&] {
    watchdog.beat();
    return pins.watchdogEdges() > 5;
  }));
  CHECK(watchdog.trips() == 0);
}

TEST_CASE(
    "the service manager hears of readiness, of life, and of the end; not of a loop that stands still") {
  Manager manager;
  setenv("WATCHDOG_USEC", "20000", 1);
  gpio::SimulatedPins pins;
  {
    Watchdog watchdog({.timeout_s = 0.05}, pins);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    CHECK(manager.heard().empty());
    watchdog.beat();
    CHECK(comes([&] { return manager.heard("READY=1") && manager.heard("WATCHDOG=1"); }));
    CHECK(comes([&] { return watchdog.trips() == 1; }));
    const std::size_t heard = manager.heard().size();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    CHECK(manager.heard().size() == heard);
  }
  CHECK(manager.heard("STOPPING=1"));
  unsetenv("WATCHDOG_USEC");
}

TEST_CASE("a watchdog of another process is not ours, and a timeout has its ceiling") {
  setenv("WATCHDOG_USEC", "20000", 1);
  CHECK(ServiceNotifier::watchdogInterval() == std::chrono::microseconds(10000));
  setenv("WATCHDOG_PID", "1", 1);
  CHECK_FALSE(ServiceNotifier::watchdogInterval());
  unsetenv("WATCHDOG_PID");
  setenv("WATCHDOG_USEC", "soon", 1);
  CHECK_FALSE(ServiceNotifier::watchdogInterval());
  unsetenv("WATCHDOG_USEC");
  CHECK_FALSE(ServiceNotifier().notify("READY=1"));
  gpio::SimulatedPins pins;
  CHECK_THROWS_AS(Watchdog({.timeout_s = 0.51}, pins), std::invalid_argument);
  CHECK_THROWS_AS(Watchdog({.timeout_s = 0.0}, pins), std::invalid_argument);
}

TEST_CASE("the watching thread wakes midway between two ticks") {
  using std::chrono::microseconds;
  using Instant = std::chrono::steady_clock::time_point;
  const auto look_us = [](int earliest_us, int tick_us, int period_us) {
    const Instant look = midwayBetweenTicks(Instant(microseconds(earliest_us)),
                                            Instant(microseconds(tick_us)), microseconds(period_us));
    return std::chrono::duration_cast<microseconds>(look.time_since_epoch()).count();
  };
  // Ticks at 250 µs of every millisecond.
  CHECK(look_us(10'300, 5'250, 1000) == 10'750);
  CHECK(look_us(10'750, 5'250, 1000) == 10'750);
  CHECK(look_us(10'751, 5'250, 1000) == 11'750);
  CHECK(look_us(11'249, 5'250, 1000) == 11'750);
  CHECK(look_us(10'300, 5'250, 0) == 10'300);
}
