#include "firmware_app/realtime/emergency_exit.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <stdexcept>
#include <system_error>

#include <poll.h>

#include "core/safety/state_machine.hpp"

namespace patella::app {
namespace {

constexpr std::array kSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGQUIT, SIGHUP, SIGXCPU};
constexpr int kRounds = 2;
constexpr int kFramesPerRound = 3;
constexpr int kBetweenRounds_ms = 3;  ///< a tick that was under way has ended

struct Means {
  gpio::Pins* pins = nullptr;
  can::Bus* bus = nullptr;
  can::CommandEncoder* encoder = nullptr;
  const Clock* clock = nullptr;
  Command stop;
};

Means g_means;                                           // NOLINT: a signal handler has no other
std::array<struct sigaction, kSignals.size()> g_before;  // NOLINT: likewise
alignas(16) std::array<std::byte, 64 * 1024> g_stack;    // NOLINT: for a thread that ran out of its own

}  // namespace

EmergencyExit::EmergencyExit(gpio::Pins& pins, can::Bus& bus, can::CommandEncoder& encoder,
                             const Clock& clock, int joints) {
  if (g_means.pins != nullptr) {
    throw std::logic_error("there is an emergency exit already");
  }
  begun_.store(false, std::memory_order_relaxed);
  g_means = {&pins, &bus, &encoder, &clock, {}};
  g_means.stop.torque_Nm = JointVector::Zero(joints);
  g_means.stop.state = static_cast<std::uint8_t>(safety::State::kFault);
  stack_t stack{};
  stack.ss_sp = g_stack.data();
  stack.ss_size = g_stack.size();
  sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_handler = &EmergencyExit::onSignal;
  action.sa_flags = SA_ONSTACK;
  sigfillset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (sigaction(kSignals[i], &action, &g_before[i]) != 0) {
      throw std::system_error(errno, std::generic_category(), "sigaction");
    }
  }
}

EmergencyExit::~EmergencyExit() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &g_before[i], nullptr);
  }
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  sigaltstack(&none, nullptr);
  g_means = {};
}

void EmergencyExit::onSignal(int signal) noexcept {
  begun_.store(true, std::memory_order_relaxed);
  for (int round = 0; round < kRounds; ++round) {
    g_means.pins->setDriveEnable(false);
    for (int i = 0; i < kFramesPerRound; ++i) {
      can::Frame frame = g_means.encoder->encode(g_means.stop);
      g_means.bus->send(frame, g_means.clock->now());
    }
    if (round + 1 < kRounds) {
      poll(nullptr, 0, kBetweenRounds_ms);
    }
  }
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (kSignals[i] == signal) {
      sigaction(signal, &g_before[i], nullptr);
    }
  }
  raise(signal);  // blocked in the handler: acts when it returns
}

}  // namespace patella::app
