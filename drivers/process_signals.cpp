#include "drivers/process_signals.hpp"

namespace patella {
namespace {

sigset_t sentToTheProcess() noexcept {
  sigset_t signals;
  sigfillset(&signals);
  for (const int signal : kSignalsOfFaults) {
    sigdelset(&signals, signal);
  }
  return signals;
}

}  // namespace

ProcessSignalsLeft::ProcessSignalsLeft() noexcept {
  const sigset_t signals = sentToTheProcess();
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
}

ProcessSignalsLeft::~ProcessSignalsLeft() {
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void takeProcessSignals() noexcept {
  const sigset_t signals = sentToTheProcess();
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

}  // namespace patella
