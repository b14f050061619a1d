// A process that runs the real loop, with the real threads and signal handlers, on the in-process rig; what
// it does to bus and enable line is noted down in memory that outlives it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <sys/types.h>

#include "core/safety/state_machine.hpp"

namespace patella::test {

enum class Deed : std::uint8_t {
  kTorque,  ///< a command that is not zero went out
  kZero,    ///< a command of zero torque with drives disabled went out
  kEnable,
  kDisable,
};

struct Entry {
  std::atomic<std::int64_t> time_ns{0};  ///< 0 until the rest is written
  Deed deed = Deed::kZero;
  std::uint8_t counter = 0;  ///< of the command
  bool letting_go = false;   ///< an emergency exit had begun
};

/// Threads of the process that can be made to run out of stack.
enum class Place : int { kNone, kMain, kLoop, kWatchdog, kRig };

/// Shared between test and process.
struct Ledger {
  std::array<Entry, 1 << 15> entries;
  std::atomic<std::uint32_t> count{0};
  std::atomic<pid_t> process{0};
  std::atomic<pid_t> loop_thread{0};
  std::atomic<pid_t> reacting_thread{0};                   ///< the first that a signal's handler ran in
  std::atomic<safety::State> state{safety::State::kInit};  ///< as the latest command says
  std::atomic<int> status{-1};                             ///< as of waitpid(2)
  std::atomic<Place> overflow{Place::kNone};

  void note(Deed deed, std::uint8_t counter = 0) noexcept;
  /// The calling thread is within a signal's handler.
  void reacts() noexcept;
};

struct RunOptions {
  bool ignore_hangup = false;  ///< as nohup does
  bool ignore_quit = false;    ///< as a shell without job control does for what it starts in the background
  bool block_everything = false;  ///< as a careless parent does
  bool first_process = false;     ///< of a PID namespace, as in a container
};

/// Observations from the instant of a signal on. Times in ms after it; negative where there was none.
/// Commands are counted as well: a host that stands still delays a time, and adds no command.
struct Aftermath {
  double torque_until_ms = -1.0;  ///< last command that was not zero
  double line_low_ms = -1.0;
  double first_zero_ms = -1.0;
  bool line_stayed_low = false;
  std::size_t torque_commands = 0;  ///< that were not zero
  std::vector<int> zero_counters;   ///< of the loop's zero commands, in their order
  std::vector<int> exit_counters;   ///< likewise of those since an emergency exit began
};

class WatchedRun {
 public:
  explicit WatchedRun(const RunOptions& options = {});
  /// Ends what still runs.
  ~WatchedRun();
  WatchedRun(const WatchedRun&) = delete;
  WatchedRun& operator=(const WatchedRun&) = delete;

  /// False where the process could not be started as it was to be (first_process takes rights).
  bool started() const { return ledger_->process.load() > 0; }
  /// Waits until the loop commands torque. False where it does not come to that, as on a host that stands
  /// still for too long.
  bool becomesActive();

  /// Sends a signal to the process, or to its loop thread. The aftermath counts from the first one.
  void send(int signal);
  void sendToLoopThread(int signal);
  void overflow(Place place);

  /// Waits for the end; status as of waitpid(2), -1 where it did not come.
  int wait();
  bool alive();
  /// Waits until `commands` of torque followed the signal. False where the loop stops or dies before.
  bool goesOn(std::size_t commands);
  /// The loop's thread was the first to react: it waits for no other.
  bool loopReacted() const { return ledger_->reacting_thread.load() == ledger_->loop_thread.load(); }
  Aftermath aftermath() const;

 private:
  /// The latest `count` entries are of torque and a high line.
  bool lately(std::uint32_t count) const;
  bool stopped() const;

  Ledger* ledger_;
  pid_t child_ = -1;
  int status_ = -1;
  std::int64_t signal_ns_ = 0;
};

}  // namespace patella::test
