// Which thread takes the signals that are sent to the process. The kernel asks the main thread first
// (signal(7)), which a busy host lets wait; the loop thread is the one that the host lets run.
#pragma once

#include <algorithm>
#include <array>
#include <csignal>

namespace patella {

/// What a fault of a thread's own raises, and comes to that thread alone.
constexpr std::array kSignalsOfFaults{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGABRT, SIGSYS};
constexpr bool isOfAFault(int signal) {
  return std::ranges::find(kSignalsOfFaults, signal) != kSignalsOfFaults.end();
}

/// While it lives, the calling thread and those that it starts leave to others what is sent to the process,
/// but for the signals of faults: blocked, the kernel would end the process without their handler.
class ProcessSignalsLeft {
 public:
  ProcessSignalsLeft() noexcept;
  ~ProcessSignalsLeft();
  ProcessSignalsLeft(const ProcessSignalsLeft&) = delete;
  ProcessSignalsLeft& operator=(const ProcessSignalsLeft&) = delete;

 private:
  sigset_t before_{};
};

/// From here on the calling thread takes what is sent to the process.
void takeProcessSignals() noexcept;

}  // namespace patella
