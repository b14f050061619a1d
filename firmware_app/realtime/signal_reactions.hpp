// The program's reaction to each signal of Linux: one table, from which the handlers are set, and against
// which docs/safety.md and the tests are held.
#pragma once

#include <array>
#include <csignal>
#include <cstdint>
#include <string_view>

namespace patella::app {

enum class Reaction : std::uint8_t {
  kLetGo,        ///< torque off, then the default action, which ends the process (EmergencyExit)
  kEnd,          ///< the run ends as after its duration
  kIgnored,      ///< on purpose
  kHarmless,     ///< by default, without anything being done
  kUncatchable,  ///< the drives' watchdog and the hardware behind the heartbeat lines are what is left
};

std::string_view reactionName(Reaction reaction) noexcept;

struct SignalRow {
  std::string_view name;
  int first;
  int last;
  Reaction reaction;
  std::string_view why;
  bool stays_ignored = false;  ///< where whoever started the program had it ignored
};

inline constexpr int kSignalCount = 64;
// The C library keeps two for itself, below its own SIGRTMIN (nptl(7)).
inline constexpr int kFirstHidden = 32;
inline constexpr int kLastHidden = 33;

inline constexpr std::array kSignals = {
    SignalRow{"SIGHUP", SIGHUP, SIGHUP, Reaction::kLetGo,
              "the terminal is gone; where ignored from the start, as under nohup, it stays ignored", true},
    SignalRow{"SIGINT", SIGINT, SIGINT, Reaction::kEnd, "Ctrl-C"},
    SignalRow{"SIGQUIT", SIGQUIT, SIGQUIT, Reaction::kLetGo, "Ctrl-\\, for a core dump"},
    SignalRow{"SIGILL", SIGILL, SIGILL, Reaction::kLetGo, "defect of the program"},
    SignalRow{"SIGTRAP", SIGTRAP, SIGTRAP, Reaction::kLetGo, "breakpoint without a debugger"},
    SignalRow{"SIGABRT", SIGABRT, SIGABRT, Reaction::kLetGo, "assertion, exception that nobody caught"},
    SignalRow{"SIGBUS", SIGBUS, SIGBUS, Reaction::kLetGo, "defect of program or memory"},
    SignalRow{"SIGFPE", SIGFPE, SIGFPE, Reaction::kLetGo, "defect of the program"},
    SignalRow{"SIGKILL", SIGKILL, SIGKILL, Reaction::kUncatchable, "the kernel ends the process"},
    SignalRow{"SIGUSR1", SIGUSR1, SIGUSR1, Reaction::kLetGo, "means nothing here and would end the process"},
    SignalRow{"SIGSEGV", SIGSEGV, SIGSEGV, Reaction::kLetGo, "defect of the program, stack overflow"},
    SignalRow{"SIGUSR2", SIGUSR2, SIGUSR2, Reaction::kLetGo, "means nothing here and would end the process"},
    SignalRow{"SIGPIPE", SIGPIPE, SIGPIPE, Reaction::kIgnored,
              "nobody reads what is printed: no reason to end a motion"},
    SignalRow{"SIGALRM", SIGALRM, SIGALRM, Reaction::kLetGo, "a timer set by whoever started the program"},
    SignalRow{"SIGTERM", SIGTERM, SIGTERM, Reaction::kEnd, "asked to end"},
    SignalRow{"SIGSTKFLT", SIGSTKFLT, SIGSTKFLT, Reaction::kLetGo, "unused by Linux, would end the process"},
    SignalRow{"SIGCHLD", SIGCHLD, SIGCHLD, Reaction::kHarmless, "there are no children"},
    SignalRow{"SIGCONT", SIGCONT, SIGCONT, Reaction::kHarmless,
              "the ticks missed since SIGSTOP are a latched stop"},
    SignalRow{"SIGSTOP", SIGSTOP, SIGSTOP, Reaction::kUncatchable, "the kernel stops the process"},
    SignalRow{"SIGTSTP", SIGTSTP, SIGTSTP, Reaction::kEnd,
              "Ctrl-Z: a process that stands still cannot watch"},
    SignalRow{"SIGTTIN", SIGTTIN, SIGTTIN, Reaction::kIgnored,
              "a run in the background must not be stopped by its terminal"},
    SignalRow{"SIGTTOU", SIGTTOU, SIGTTOU, Reaction::kIgnored,
              "a run in the background must not be stopped by its terminal"},
    SignalRow{"SIGURG", SIGURG, SIGURG, Reaction::kHarmless, "no socket asks for it"},
    SignalRow{"SIGXCPU", SIGXCPU, SIGXCPU, Reaction::kLetGo, "limit of processor time, RLIMIT_RTTIME too"},
    SignalRow{"SIGXFSZ", SIGXFSZ, SIGXFSZ, Reaction::kIgnored,
              "a file that may not grow is a failed recording, and no reason to end a motion"},
    SignalRow{"SIGVTALRM", SIGVTALRM, SIGVTALRM, Reaction::kLetGo,
              "a timer set by whoever started the program"},
    SignalRow{"SIGPROF", SIGPROF, SIGPROF, Reaction::kLetGo, "a timer set by whoever started the program"},
    SignalRow{"SIGWINCH", SIGWINCH, SIGWINCH, Reaction::kHarmless, "the terminal has another size"},
    SignalRow{"SIGIO", SIGIO, SIGIO, Reaction::kLetGo, "no descriptor asks for it; it would end the process"},
    SignalRow{"SIGPWR", SIGPWR, SIGPWR, Reaction::kEnd,
              "the power is about to fail: the recording is closed"},
    SignalRow{"SIGSYS", SIGSYS, SIGSYS, Reaction::kLetGo, "a system call that is forbidden"},
    SignalRow{
        "SIGCANCEL, SIGSETXID", kFirstHidden, kLastHidden, Reaction::kIgnored,
        "the C library's, which refuses handlers; for pthread_cancel() and setuid(), which are not used"},
    SignalRow{"SIGRTMIN to SIGRTMAX", kLastHidden + 1, kSignalCount, Reaction::kLetGo,
              "mean nothing here and would end the process"},
};

constexpr const SignalRow& rowOf(int signal) {
  for (const SignalRow& row : kSignals) {
    if (signal >= row.first && signal <= row.last) {
      return row;
    }
  }
  throw "a signal without a row";
}

/// Each signal stands in one row.
constexpr bool isComplete() {
  int count = 0;
  for (const SignalRow& row : kSignals) {
    count += row.last - row.first + 1;
  }
  for (int signal = 1; signal <= kSignalCount; ++signal) {
    rowOf(signal);
  }
  return count == kSignalCount;
}
static_assert(isComplete() && kSignalCount == NSIG - 1);

/// At the start of the program, before any thread: has `end` called for the signals that end a run, ignores
/// those that are ignored on purpose, and unblocks all, whatever whoever started the program left. Throws
/// std::system_error.
void reactToSignals(void (*end)(int));

}  // namespace patella::app
