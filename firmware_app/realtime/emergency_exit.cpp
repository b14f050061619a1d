#include "firmware_app/realtime/emergency_exit.hpp"

#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <system_error>

#include <poll.h>
#include <unistd.h>

#include "core/safety/state_machine.hpp"

namespace patella::app {
namespace {

constexpr int kRounds = 2;
constexpr int kFramesPerRound = 3;
constexpr int kBetweenRounds_ms = 3;  ///< a tick that was under way has ended
constexpr int kForTheFirst_ms = 50;   ///< for another thread that lets go; it takes a tenth of that

struct Means {
  gpio::Pins* pins = nullptr;
  can::Bus* bus = nullptr;
  can::CommandEncoder* encoder = nullptr;
  const Clock* clock = nullptr;
  std::array<can::Frame, kMaxJoints> stop;  ///< zero torque for each drive, but for counter and CRC
};

Means g_means;                      // NOLINT: a signal handler has no other
std::atomic<bool> g_armed{false};   // NOLINT: likewise; the means may be used
std::atomic<int> g_in_handlers{0};  // NOLINT: likewise; threads that may be using them

void letGo() noexcept {
  for (int round = 0; round < kRounds; ++round) {
    g_means.pins->setDriveEnable(false);
    for (int i = 0; i < kFramesPerRound; ++i) {
      for (std::size_t drive = 0; drive < g_means.encoder->size(); ++drive) {
        can::DriveCommand& command = g_means.encoder->drive(drive);
        can::Frame frame = g_means.stop[drive];
        command.seal(frame);
        g_means.bus->send(frame, g_means.clock->now());
        for (can::Frame leave : command.frames(safety::DriveFrames::kLeave)) {
          g_means.bus->send(leave, g_means.clock->now());
        }
      }
    }
    if (round + 1 < kRounds) {
      poll(nullptr, 0, kBetweenRounds_ms);
    }
  }
}

// By the default action, not by what was set before: ignored there, the process would live on without a loop.
[[noreturn]] void die(int signal) noexcept {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  sigaction(signal, &action, nullptr);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  raise(signal);
  // Only the first process of a container comes here: no default action ends it (pid_namespaces(7)).
  _exit(128 + signal);
}

}  // namespace

EmergencyExit::EmergencyExit(gpio::Pins& pins, can::Bus& bus, can::CommandEncoder& encoder,
                             const Clock& clock, int joints) {
  if (g_means.pins != nullptr) {
    throw std::logic_error("there is an emergency exit already");
  }
  begun_.store(false, std::memory_order_relaxed);
  g_means = {&pins, &bus, &encoder, &clock, {}};
  Command stop;
  stop.torque_Nm = JointVector::Zero(joints);
  stop.state = static_cast<std::uint8_t>(safety::State::kFault);
  for (std::size_t drive = 0; drive < encoder.size(); ++drive) {
    g_means.stop[drive] = encoder.drive(drive).encode(stop);
  }
  g_armed.store(true);
  struct sigaction action {};
  action.sa_handler = &EmergencyExit::onSignal;
  action.sa_flags = SA_ONSTACK;
  sigfillset(&action.sa_mask);
  for (int signal = 1; signal <= kSignalCount; ++signal) {
    const SignalRow& row = rowOf(signal);
    if (row.reaction != Reaction::kLetGo) {
      continue;
    }
    const auto index = static_cast<std::size_t>(signal);
    bool done = sigaction(signal, nullptr, &before_[index]) == 0;
    if (done && !(row.stays_ignored && before_[index].sa_handler == SIG_IGN)) {
      done = sigaction(signal, &action, nullptr) == 0;
      set_[index] = done;
    }
    if (!done) {
      const int error = errno;
      putBack();
      throw std::system_error(error, std::generic_category(), "sigaction for " + std::string(row.name));
    }
  }
}

EmergencyExit::~EmergencyExit() {
  putBack();
}

void EmergencyExit::putBack() noexcept {
  g_armed.store(false);
  while (g_in_handlers.load() != 0) {
    poll(nullptr, 0, kForTheFirst_ms);
  }
  for (int signal = 1; signal <= kSignalCount; ++signal) {
    if (set_[static_cast<std::size_t>(signal)]) {
      sigaction(signal, &before_[static_cast<std::size_t>(signal)], nullptr);
    }
  }
  g_means = {};
}

void EmergencyExit::onSignal(int signal) noexcept {
  // Counted before it is asked whether the means are there; the destructor does it the other way round, so
  // that one of the two sees the other.
  g_in_handlers.fetch_add(1);
  if (g_armed.load()) {
    if (!begun_.exchange(true)) {
      letGo();
    } else {
      poll(nullptr, 0, kForTheFirst_ms);  // a second thread's frames would disturb the first one's
    }
  }
  die(signal);
}

}  // namespace patella::app
