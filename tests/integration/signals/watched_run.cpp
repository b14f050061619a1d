#include "tests/integration/signals/watched_run.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <thread>

#include <sched.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/bounds/bounds.hpp"
#include "drivers/signal_stack.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/loop/loop_thread.hpp"
#include "firmware_app/realtime/emergency_exit.hpp"
#include "firmware_app/realtime/signal_reactions.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "sim/rig_thread.hpp"
#include "tests/support/fresh_signals.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

constexpr auto kLook = std::chrono::milliseconds(1);
constexpr auto kLongestWait = std::chrono::seconds(10);
constexpr auto kLongestStart = std::chrono::seconds(2);  ///< the operator's press came too early by then
constexpr std::uint64_t kLongestRun = 16'000;            ///< ticks; whoever started it may be gone
constexpr std::uint32_t kEntriesWhenActive = 40;         ///< of torque and a high line in a row

constexpr int kOfTheChild = -2;  ///< in Ledger::status: the child's own is the process's

std::int64_t now_ns() noexcept {
  return MonotonicClock().now();
}

template <typename Condition>
bool comes(Condition&& condition, std::chrono::seconds limit = kLongestWait) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(kLook);
  }
  return true;
}

/// Runs out of stack; what it reads keeps the compiler from knowing.
[[gnu::noinline]] int fall(int depth) noexcept {
  static volatile bool bottomless = true;
  volatile char frame[1024];
  frame[0] = static_cast<char>(depth);
  return bottomless ? fall(depth + 1) + frame[0] : 0;
}

void fallAt(Ledger& ledger, Place place) noexcept {
  if (ledger.overflow.load(std::memory_order_relaxed) == place) {
    fall(0);
  }
}

class NotingBus final : public can::Bus {
 public:
  NotingBus(sim::RigThread& bus, Ledger& ledger) noexcept : bus_(bus), ledger_(ledger) {}
  /// The loop is set up: the rig's time begins now, so that the operator's press comes neither too early nor
  /// late.
  void discardPending() noexcept override { bus_.start(); }
  std::size_t receive(std::span<can::Frame> frames, std::int64_t now) noexcept PATELLA_NONBLOCKING override {
    fallAt(ledger_, Place::kLoop);
    if (ledger_.loop_thread.load(std::memory_order_relaxed) == 0) {
      ledger_.loop_thread.store(gettid(), std::memory_order_relaxed);
    }
    return bus_.receive(frames, now);
  }
  // TorqueCommand of patella.dbc: torque in bytes 0 to 4, enable and state in byte 5, counter in byte 6.
  can::SendResult send(can::Frame& frame, std::int64_t now) noexcept PATELLA_NONBLOCKING override {
    bool zero = (frame.data[5] & 1U) == 0;
    for (std::size_t i = 0; i < 5; ++i) {
      zero = zero && frame.data[i] == 0;
    }
    ledger_.note(zero ? Deed::kZero : Deed::kTorque, frame.data[6]);
    ledger_.state.store(static_cast<safety::State>((frame.data[5] >> 1U) & 7U), std::memory_order_relaxed);
    return bus_.send(frame, now);
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }

 private:
  sim::RigThread& bus_;
  Ledger& ledger_;
};

class NotingPins final : public gpio::Pins {
 public:
  explicit NotingPins(Ledger& ledger) noexcept : ledger_(ledger) {}
  bool emergencyStop() noexcept PATELLA_NONBLOCKING override { return false; }
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override {
    if (app::EmergencyExit::begun()) {
      ledger_.reacts();
    }
    ledger_.note(enabled ? Deed::kEnable : Deed::kDisable);
    return true;
  }
  bool setHeartbeat(bool) noexcept PATELLA_NONBLOCKING override { return true; }
  void setWatchdogHeartbeat(bool) noexcept override { fallAt(ledger_, Place::kWatchdog); }

 private:
  Ledger& ledger_;
};

/// The rig's, whose thread can fall while it sleeps.
class FallingClock final : public Clock {
 public:
  explicit FallingClock(Ledger& ledger) noexcept : ledger_(ledger) {}
  std::int64_t now() const noexcept PATELLA_NONBLOCKING override { return clock_.now(); }
  std::int64_t wallNow() const noexcept PATELLA_NONBLOCKING override { return clock_.wallNow(); }
  void sleepUntil(std::int64_t instant_ns) noexcept override {
    fallAt(ledger_, Place::kRig);
    clock_.sleepUntil(instant_ns);
  }

 private:
  MonotonicClock clock_;
  Ledger& ledger_;
};

std::atomic<bool> g_stop{false};
std::atomic<Ledger*> g_ledger{nullptr};

void end(int /*signal*/) {
  g_stop.store(true);
  g_ledger.load()->reacts();
}

/// Signals as a fresh process has them that somebody else started; the test framework has its own.
void inherit(const RunOptions& options) {
  useFreshSignals(app::kSignalCount);
  if (options.ignore_hangup) {
    std::signal(SIGHUP, SIG_IGN);
  }
  if (options.ignore_quit) {
    std::signal(SIGQUIT, SIG_IGN);
  }
  sigset_t mask;
  sigemptyset(&mask);
  if (options.block_everything) {
    sigfillset(&mask);
  }
  sigprocmask(SIG_SETMASK, &mask, nullptr);
}

/// As runLoop() does, but for the recording. A busy host is not the subject: nothing is late.
int runLoop(Ledger& ledger) {
  g_ledger.store(&ledger);
  app::reactToSignals(end);
  app::CommandLine line;
  line.config = checkout::source() / "firmware_app/config/adult.toml";
  app::RunConfig config = app::loadRunConfig(line);
  constexpr double kPatience_s = 0.5;
  config.duration_s = 0.0;
  config.loop.max_ticks = kLongestRun;
  config.loop.overruns_tolerated = 100;
  config.loop.stall_tolerated_s = boundOf("loop.stall_tolerated_s").rehearsal_maximum;
  config.watchdog.timeout_s = boundOf("loop.watchdog_timeout_s").rehearsal_maximum;
  config.bus.map.encoder_timeout_s = kPatience_s;
  config.bus.map.drive_timeout_s = kPatience_s;
  config.bus.map.emg_timeout_s = kPatience_s;
  config.rig.drive.watchdog_s = kPatience_s;
  config.rig.operator_buttons.enable_at_s = 0.1;  // the loop has seen it released by then
  config.realtime.prefault_heap_bytes = 1 << 20;  // many at once are to start quickly

  const MonotonicClock clock;
  MonotonicClock loop_clock;
  FallingClock rig_clock(ledger);
  const auto rig = app::makeRig(config);
  sim::RigThread rig_thread(*rig, rig_clock, config.realtime.priority);
  NotingBus bus(rig_thread, ledger);
  NotingPins pins(ledger);
  can::MeasurementDecoder decoder = app::makeDecoder(config);
  can::CommandEncoder encoder = app::makeEncoder(config);
  const auto tick = app::makeTick(config);
  app::RunAccount account;
  app::Loop loop({.options = config.loop,
                  .clock = loop_clock,
                  .bus = bus,
                  .pins = pins,
                  .decoder = decoder,
                  .encoder = encoder,
                  .tick = *tick,
                  .sink = account});
  const SignalStack stack;
  const SignalStack::InUse in_use(stack);
  app::WatchdogOptions options = config.watchdog;
  options.loop_period_s = 1.0 / config.loop.rate_Hz;
  options.priority = config.realtime.priority + 1;
  app::Watchdog watchdog(options, pins);
  loop.watchedBy(watchdog);
  const app::EmergencyExit exit(pins, bus, encoder, clock, config.model.joints());
  app::runOnThread(loop, config.realtime, g_stop, [&ledger] { fallAt(ledger, Place::kMain); });
  return account.statistics().final_state == safety::State::kActive ? 0 : 3;
}

[[noreturn]] void live(Ledger& ledger, const RunOptions& options) noexcept {
  int status = 99;
  try {
    inherit(options);
    status = runLoop(ledger);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "watched run: %s\n", error.what());
  }
  _exit(status);
}

/// The first process of a namespace cannot be waited for from outside of it but by the one who made it.
[[noreturn]] void liveFirst(Ledger& ledger, const RunOptions& options) noexcept {
  const pid_t first = unshare(CLONE_NEWPID) == 0 ? fork() : -1;
  if (first == 0) {
    live(ledger, options);
  }
  ledger.process.store(first);
  int status = -1;
  if (first > 0 && waitpid(first, &status, 0) == first) {
    ledger.status.store(status);
  }
  _exit(0);
}

}  // namespace

void Ledger::note(Deed deed, std::uint8_t counter) noexcept {
  const std::uint32_t index = count.fetch_add(1);
  if (index < entries.size()) {
    entries[index].deed = deed;
    entries[index].counter = counter;
    entries[index].letting_go = app::EmergencyExit::begun();
    entries[index].time_ns.store(now_ns());
  }
}

void Ledger::reacts() noexcept {
  pid_t nobody = 0;
  reacting_thread.compare_exchange_strong(nobody, gettid());
}

WatchedRun::WatchedRun(const RunOptions& options) {
  void* const memory =
      mmap(nullptr, sizeof(Ledger), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    throw std::bad_alloc();
  }
  ledger_ = new (memory) Ledger;
  child_ = fork();
  if (child_ == 0) {
    options.first_process ? liveFirst(*ledger_, options) : live(*ledger_, options);
  }
  if (!options.first_process) {
    ledger_->process.store(child_);
    ledger_->status.store(kOfTheChild);
  } else {
    comes([this] { return ledger_->process.load() != 0; });
  }
}

WatchedRun::~WatchedRun() {
  if (alive()) {
    kill(started() ? ledger_->process.load() : child_, SIGKILL);
    wait();
  }
  munmap(ledger_, sizeof(Ledger));
}

bool WatchedRun::lately(std::uint32_t count) const {
  const std::uint32_t end = ledger_->count.load();
  if (end < count || end > ledger_->entries.size()) {
    return false;
  }
  for (std::uint32_t i = end - count; i < end; ++i) {
    const Entry& entry = ledger_->entries[i];
    if (entry.time_ns.load() != 0 && entry.deed != Deed::kTorque && entry.deed != Deed::kEnable) {
      return false;
    }
  }
  return true;
}

bool WatchedRun::stopped() const {
  const safety::State state = ledger_->state.load(std::memory_order_relaxed);
  return state == safety::State::kFault || state == safety::State::kLimited;
}

bool WatchedRun::becomesActive() {
  const auto decided = [this] { return lately(kEntriesWhenActive) || stopped() || !alive(); };
  return comes(decided, kLongestStart) && !stopped() && alive();
}

void WatchedRun::send(int signal) {
  signal_ns_ = signal_ns_ == 0 ? now_ns() : signal_ns_;
  kill(ledger_->process.load(), signal);
}

void WatchedRun::sendToLoopThread(int signal) {
  signal_ns_ = signal_ns_ == 0 ? now_ns() : signal_ns_;
  syscall(SYS_tgkill, ledger_->process.load(), ledger_->loop_thread.load(), signal);
}

void WatchedRun::overflow(Place place) {
  signal_ns_ = now_ns();
  ledger_->overflow.store(place);
}

bool WatchedRun::alive() {
  if (child_ > 0) {
    int status = -1;
    if (waitpid(child_, &status, WNOHANG) == child_) {
      child_ = -1;
      const int relayed = ledger_->status.load();
      status_ = relayed == kOfTheChild ? status : relayed;
    }
  }
  return child_ > 0;
}

int WatchedRun::wait() {
  comes([this] { return !alive(); });
  return status_;
}

bool WatchedRun::goesOn(std::size_t commands) {
  const auto gone_on = [&] { return aftermath().torque_commands >= commands; };
  return comes([&] { return gone_on() || stopped() || !alive(); }) && gone_on();
}

Aftermath WatchedRun::aftermath() const {
  Aftermath after;
  const std::uint32_t end =
      std::min(ledger_->count.load(), static_cast<std::uint32_t>(ledger_->entries.size()));
  for (std::uint32_t i = 0; i < end; ++i) {
    const Entry& entry = ledger_->entries[i];
    const double time_ms = static_cast<double>(entry.time_ns.load() - signal_ns_) * 1e-6;
    if (time_ms < 0.0) {
      continue;
    }
    switch (entry.deed) {
      case Deed::kTorque:
        after.torque_until_ms = time_ms;
        ++after.torque_commands;
        break;
      case Deed::kZero:
        after.first_zero_ms = after.first_zero_ms < 0.0 ? time_ms : after.first_zero_ms;
        (entry.letting_go ? after.exit_counters : after.zero_counters).push_back(entry.counter);
        break;
      case Deed::kEnable:
        after.line_stayed_low = false;
        break;
      case Deed::kDisable:
        after.line_low_ms = after.line_low_ms < 0.0 ? time_ms : after.line_low_ms;
        after.line_stayed_low = true;
        break;
    }
  }
  return after;
}

}  // namespace patella::test
