#include "firmware_app/realtime/signal_reactions.hpp"

#include <cerrno>
#include <system_error>

#include <sys/syscall.h>
#include <unistd.h>

namespace patella::app {
namespace {

void require(bool done, const SignalRow& row) {
  if (!done) {
    throw std::system_error(errno, std::generic_category(), std::string(row.name) + ": sigaction");
  }
}

// The kernel's own struct sigaction, which the C library does not show. All but the handler stay zero, so
// that the order of what follows it, which differs between machines, is the same for all.
struct KernelAction {
  void (*handler)(int) = nullptr;
  std::array<unsigned long, 4> rest{};
};
constexpr std::size_t kKernelMaskBytes = kSignalCount / 8;

// The C library's sigaction() refuses these. Where it has set a handler of its own, that is as harmless.
bool ignoreHidden(int signal) {
  KernelAction action;
  if (syscall(SYS_rt_sigaction, signal, nullptr, &action, kKernelMaskBytes) != 0) {
    return false;
  }
  if (action.handler != SIG_DFL) {
    return true;
  }
  action = {};
  action.handler = SIG_IGN;
  return syscall(SYS_rt_sigaction, signal, &action, nullptr, kKernelMaskBytes) == 0;
}

bool set(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_ONSTACK | SA_RESTART;
  return sigaction(signal, &action, nullptr) == 0;
}

}  // namespace

std::string_view reactionName(Reaction reaction) noexcept {
  switch (reaction) {
    case Reaction::kLetGo:
      return "lets go and dies";
    case Reaction::kEnd:
      return "ends the run";
    case Reaction::kIgnored:
      return "ignored on purpose";
    case Reaction::kHarmless:
      return "harmless by default";
    case Reaction::kUncatchable:
      return "cannot be caught";
  }
  return "";
}

void reactToSignals(void (*end)(int)) {
  for (const SignalRow& row : kSignals) {
    for (int signal = row.first; signal <= row.last; ++signal) {
      if (row.reaction == Reaction::kEnd) {
        require(set(signal, end), row);
      } else if (row.reaction == Reaction::kIgnored) {
        const bool hidden = signal >= kFirstHidden && signal <= kLastHidden;
        require(hidden ? ignoreHidden(signal) : set(signal, SIG_IGN), row);
      }
    }
  }
  // Blocked by whoever started the program, a fault of the program would end it without its handler.
  sigset_t none;
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace patella::app
