// Last actions of a dying process. The same with the whole loop is in tests/integration/signals.
#include "firmware_app/realtime/emergency_exit.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/can/dbc.hpp"
#include "tests/support/fresh_signals.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::app;
using namespace patella::test;

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
  bool setHeartbeat(bool) noexcept PATELLA_NONBLOCKING override { return true; }
  std::size_t receive(std::span<can::Frame>, std::int64_t) noexcept PATELLA_NONBLOCKING override { return 0; }
  can::SendResult send(can::Frame& frame, std::int64_t) noexcept PATELLA_NONBLOCKING override {
    bool zero = (frame.data[5] & 1U) == 0;
    for (int i = 0; i < 5; ++i) {
      zero = zero && frame.data[static_cast<std::size_t>(i)] == 0;
    }
    // A drive takes only a frame whose counter has gone on (patella.dbc, TorqueCommand).
    const bool counted = !sent_ || frame.data[6] == static_cast<std::uint8_t>(counter_ + 1);
    sent_ = true;
    counter_ = frame.data[6];
    put(!counted ? 'c' : zero ? '0' : 'T');
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
  bool sent_ = false;
  std::uint8_t counter_ = 0;
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
  int exit_status = 0;
};

constexpr int kNoSuchSignal = 77;

/// User emulation keeps the last two signals for itself; no kernel refuses one.
void raiseOrExit(int signal) {
  if (raise(signal) != 0) {
    _exit(kNoSuchSignal);
  }
}

/// Traces of a process that lives like this; `live` gets the parts of its emergency exit.
Death dieOf(const std::function<void(Reporting&, can::CommandEncoder&, const Clock&)>& live) {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const can::Database database = can::loadDbc(checkout::source() / "drivers/can/patella.dbc");
  const pid_t child = fork();
  if (child == 0) {
    useFreshSignals(kSignalCount);
    Reporting means(ends[1]);
    can::CommandEncoder encoder = commandEncoder(database);
    const MonotonicClock clock;
    live(means, encoder, clock);
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
  death.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  return death;
}

}  // namespace

TEST_CASE("whatever signal ends the process, the line goes down and zero torque goes out first") {
  for (int signal = 1; signal <= kSignalCount; ++signal) {
    if (rowOf(signal).reaction != Reaction::kLetGo) {
      continue;
    }
    for (const bool in_other_thread : {false, true}) {
      CAPTURE(signal);
      CAPTURE(in_other_thread);
      const Death death = dieOf([&](Reporting& means, can::CommandEncoder& encoder, const Clock& clock) {
        const EmergencyExit exit(means, means, encoder, clock, 2);
        if (in_other_thread) {
          std::thread([signal] { raiseOrExit(signal); }).join();
        } else {
          raiseOrExit(signal);
        }
      });
      if (death.exit_status == kNoSuchSignal) {
        MESSAGE("SKIPPED: there is no signal ", signal, " here");
        continue;
      }
      CHECK(death.marks == "e000e000");
      CHECK(death.signal == signal);
    }
  }
}

TEST_CASE("ignored from the start, a hangup stays so, and every other signal still ends the process") {
  for (const int signal : {SIGHUP, SIGQUIT, SIGUSR1, SIGALRM}) {
    CAPTURE(signal);
    const Death death = dieOf([&](Reporting& means, can::CommandEncoder& encoder, const Clock& clock) {
      std::signal(signal, SIG_IGN);
      const EmergencyExit exit(means, means, encoder, clock, 2);
      raise(signal);
      if (EmergencyExit::begun()) {
        means.setDriveEnable(true);  // lives on without a loop
      }
    });
    CHECK(death.marks == (signal == SIGHUP ? "" : "e000e000"));
    CHECK(death.signal == (signal == SIGHUP ? 0 : signal));
  }
}

TEST_CASE("what a handler uses stays until it has ended the process, though the run ends meanwhile") {
  const Death death = dieOf([](Reporting& means, can::CommandEncoder& encoder, const Clock& clock) {
    std::thread other;
    {
      const EmergencyExit exit(means, means, encoder, clock, 2);
      other = std::thread([] { raise(SIGQUIT); });
      while (!EmergencyExit::begun()) {
      }
    }
    means.setDriveEnable(true);  // the means are gone, as far as the handler is concerned
    other.join();
  });
  CHECK(death.marks == "e000e000");
  CHECK(death.signal == SIGQUIT);
}

TEST_CASE("there is one emergency exit, and after it the handlers are as before") {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const can::Database database = can::loadDbc(checkout::source() / "drivers/can/patella.dbc");
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
