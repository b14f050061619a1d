// The thread that watches the loop, what it tells the service manager, and what a dying process still does.
#include "firmware_app/realtime/watchdog.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/can/dbc.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "tests/support/paths.hpp"

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

namespace {

/// Writes down in a pipe what is done to it, with nothing but system calls.
class Reporting final : public gpio::Pins, public can::Bus {
 public:
  explicit Reporting(int pipe) noexcept : pipe_(pipe) {}
  bool emergencyStop() noexcept PATELLA_NONBLOCKING override { return false; }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    put(enabled ? 'E' : 'e');
    return true;
  }
  void setHeartbeat(bool) noexcept PATELLA_NONBLOCKING override {}
  std::uint64_t errors() const noexcept override { return 0; }
  std::size_t receive(std::span<can::Frame>, std::int64_t) noexcept PATELLA_NONBLOCKING override { return 0; }
  can::SendResult send(can::Frame& frame, std::int64_t) noexcept PATELLA_NONBLOCKING override {
    bool zero = (frame.data[5] & 1U) == 0;
    for (int i = 0; i < 5; ++i) {
      zero = zero && frame.data[static_cast<std::size_t>(i)] == 0;
    }
    put(zero ? '0' : 'T');
    return can::SendResult::kSent;
  }
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

 private:
  void put(char mark) const noexcept {
    if (write(pipe_, &mark, 1) != 1) {
      _exit(99);
    }
  }
  int pipe_;
};

can::CommandEncoder commandEncoder(const can::Database& database) {
  const can::CommandMap map{.message = "TorqueCommand",
                            .bindings = {{.input = "torque_Nm.1", .message = "", .signal = "Torque1"},
                                         {.input = "torque_Nm.2", .message = "", .signal = "Torque2"},
                                         {.input = "enable", .message = "", .signal = "Enable"},
                                         {.input = "state", .message = "", .signal = "State"}},
                            .protection = {"TorqueCommand", "Counter", "Crc"}};
  return {database, map, 2};
}

struct Death {
  std::string marks;
  int signal = 0;
};

/// What a process leaves behind that dies by the signal, in its main or in another thread.
Death die(int signal, bool in_other_thread) {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const can::Database database =
      can::loadDbc(std::filesystem::path(PATELLA_SOURCE_DIR) / "drivers/can/patella.dbc");
  const pid_t child = fork();
  if (child == 0) {
    std::signal(signal, SIG_DFL);  // not the test framework's
    Reporting means(ends[1]);
    can::CommandEncoder encoder = commandEncoder(database);
    const MonotonicClock clock;
    const EmergencyExit exit(means, means, encoder, clock, 2);
    if (in_other_thread) {
      std::thread([signal] { raise(signal); }).join();
    } else {
      raise(signal);
    }
    _exit(0);
  }
  close(ends[1]);
  Death death;
  char mark = 0;
  while (read(ends[0], &mark, 1) == 1) {
    death.marks += mark;
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  death.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return death;
}

}  // namespace

TEST_CASE("whatever signal ends the process, the line goes down and zero torque goes out first") {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGQUIT, SIGHUP, SIGXCPU}) {
    for (const bool in_other_thread : {false, true}) {
      CAPTURE(signal);
      CAPTURE(in_other_thread);
      const Death death = die(signal, in_other_thread);
      CHECK(death.marks == "e000e000");
      CHECK(death.signal == signal);
    }
  }
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

TEST_CASE("there is one emergency exit, and after it the handlers are as before") {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const can::Database database =
      can::loadDbc(std::filesystem::path(PATELLA_SOURCE_DIR) / "drivers/can/patella.dbc");
  Reporting means(ends[1]);
  can::CommandEncoder encoder = commandEncoder(database);
  const MonotonicClock clock;
  struct sigaction before {};
  sigaction(SIGQUIT, nullptr, &before);
  {
    const EmergencyExit first(means, means, encoder, clock, 2);
    CHECK_THROWS_AS(EmergencyExit(means, means, encoder, clock, 2), std::logic_error);
  }
  struct sigaction after {};
  sigaction(SIGQUIT, nullptr, &after);
  const bool as_before = after.sa_handler == before.sa_handler;
  CHECK(as_before);
  CHECK_FALSE(EmergencyExit::begun());
  close(ends[0]);
  close(ends[1]);
}
