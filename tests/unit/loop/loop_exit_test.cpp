// A signal that ends the process is caught while the loop is within a tick: from then on, encoder, bus and
// enable line are the handler's. What the handler itself does is in tests/unit/realtime/emergency_exit_test.
#include <array>
#include <atomic>
#include <csignal>
#include <functional>
#include <thread>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware_app/realtime/emergency_exit.hpp"
#include "tests/support/fresh_signals.hpp"
#include "tests/unit/loop/simulated_run.hpp"

using namespace patella;
using namespace patella::app;
using namespace patella::test;
using tick::Stage;

namespace {

constexpr int kTicks = 600;
constexpr int kActiveTick = 500;
constexpr std::size_t kFramesBeforeItWaits = 3;

/// The run's bus as the handler has it. It waits there, so that the loop goes on before the process ends.
class HandlerBus final : public can::Bus {
 public:
  explicit HandlerBus(can::Bus& bus) noexcept : bus_(bus) {}
  std::size_t receive(std::span<can::Frame>, std::int64_t) noexcept PATELLA_NONBLOCKING override { return 0; }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    const can::SendResult result = bus_.send(frame, now_ns);
    if (++sent == kFramesBeforeItWaits) {
      while (!loop_has_ended) {
      }
    }
    return result;
  }
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

  std::atomic<std::size_t> sent{0};
  std::atomic<bool> loop_has_ended{false};

 private:
  can::Bus& bus_;
};

/// From the catch of the signal to the end of the loop.
struct Afterwards {
  bool caught = false;
  std::size_t frames = 0;
  bool all_zero = true;
  int encoded_by_loop = 0;
  int rises = 0;
  bool line_low = true;  ///< at the end of each tick
};

/// A run with a place to catch the signal at.
class EndedRun : public SimulatedRun {
 public:
  EndedRun() {
    script = [this](int number) { tick = number; };
    loop_pins.before_rise = [this] { rises += caught_at_ < 0 ? 0 : 1; };
  }

  /// Called in the loop: returns when the handler, in another thread, has sent its first frames.
  void catchSignal() noexcept {
    if (caught_at_ >= 0) {
      return;
    }
    caught_at_ = tick;
    frames_before_ = bus.tried.size();
    raise_ = true;
    while (handler_bus_.sent < kFramesBeforeItWaits) {
    }
  }

  /// Runs, hands over what was seen, and ends by the signal.
  [[noreturn]] void end(const std::function<void(const Afterwards&)>& hand_over) {
    const EmergencyExit exit(loop_pins, handler_bus_, encoder(), clock, 2);
    std::thread other([this] {
      while (!raise_) {
      }
      raise(SIGQUIT);
    });
    run(kTicks);
    hand_over(afterwards());
    raise_ = true;
    handler_bus_.loop_has_ended = true;
    other.join();
    _exit(0);
  }

  int tick = 0;
  int rises = 0;

 private:
  Afterwards afterwards() {
    Afterwards seen;
    seen.caught = caught_at_ >= 0;
    if (!seen.caught) {
      return seen;
    }
    seen.frames = bus.tried.size() - frames_before_;
    for (std::size_t i = frames_before_; i < bus.tried.size(); ++i) {
      const CommandSeen command(bus.tried[i]);
      seen.all_zero = seen.all_zero && command.torque_is_zero && !command.enable;
    }
    const int newest = bus.tried.back().data[6];  // the counter of TorqueCommand
    Command zero;
    zero.torque_Nm = JointVector::Zero(2);
    seen.encoded_by_loop = static_cast<std::uint8_t>(encoder().encode(zero).data[6] - newest - 1);
    seen.rises = rises;
    for (int t = caught_at_; t < kTicks - 1; ++t) {
      seen.line_low = seen.line_low && !driveEnable(t);
    }
    return seen;
  }

  HandlerBus handler_bus_{bus};
  std::atomic<bool> raise_{false};
  int caught_at_ = -1;
  std::size_t frames_before_ = 0;
};

/// Behaviour of a loop in a process of its own after the signal; `prepare` says where it is caught.
Afterwards afterSignal(const std::function<void(EndedRun&)>& prepare) {
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  const pid_t child = fork();
  if (child == 0) {
    useFreshSignals(kSignalCount);
    EndedRun run;
    prepare(run);
    run.end([&](const Afterwards& seen) {
      if (write(ends[1], &seen, sizeof(seen)) != static_cast<ssize_t>(sizeof(seen))) {
        _exit(1);
      }
    });
  }
  close(ends[1]);
  Afterwards seen;
  CHECK(read(ends[0], &seen, sizeof(seen)) == static_cast<ssize_t>(sizeof(seen)));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGQUIT);
  return seen;
}

}  // namespace

TEST_CASE("wherever in a tick an emergency exit begins: no frame follows its own, and the line stays low") {
  Afterwards seen;
  const auto at = [&](Stage stage) {
    seen = afterSignal([stage](EndedRun& run) {
      run.probe.at_stage = [&run, stage](Stage entered) {
        if (run.tick == kActiveTick && entered == stage) {
          run.catchSignal();
        }
      };
    });
  };
  SUBCASE("before the command is computed") {
    at(Stage::kModel);
  }
  SUBCASE("before it is encoded") {
    at(Stage::kEncode);
  }
  SUBCASE("before it is sent") {
    at(Stage::kSend);
  }
  SUBCASE("between the first torque and the rise of the line") {
    seen = afterSignal([](EndedRun& run) {
      run.probe.at_stage = [&run](Stage entered) {
        if (entered == Stage::kLinesOut && run.command(run.tick).enable) {
          run.catchSignal();
        }
      };
    });
  }
  SUBCASE("as the line rises") {
    seen = afterSignal([](EndedRun& run) { run.loop_pins.before_rise = [&run] { run.catchSignal(); }; });
  }
  CHECK(seen.caught);
  CHECK(seen.frames == kFramesBeforeItWaits);
  CHECK(seen.all_zero);
  CHECK(seen.encoded_by_loop == 0);
  CHECK(seen.rises == 0);
  CHECK(seen.line_low);
}
