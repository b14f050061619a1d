#include "firmware_app/loop/loop_thread.hpp"

#include <chrono>
#include <exception>
#include <thread>

#include "drivers/process_signals.hpp"
#include "drivers/signal_stack.hpp"

namespace patella::app {
namespace {

constexpr auto kLook = std::chrono::milliseconds(10);

}  // namespace

std::unique_ptr<RealtimeSetup> runOnThread(Loop& loop, const RealtimeOptions& options,
                                           const std::atomic<bool>& stop,
                                           const std::function<void()>& meanwhile) {
  std::unique_ptr<RealtimeSetup> setup;
  std::exception_ptr failure;
  std::atomic<bool> finished{false};
  const ProcessSignalsLeft left;
  std::thread thread = startThread([&] {
    takeProcessSignals();
    try {
      setup = std::make_unique<RealtimeSetup>(options);
      loop.run(stop);
    } catch (...) {
      failure = std::current_exception();
    }
    finished.store(true, std::memory_order_release);
  });
  while (!finished.load(std::memory_order_acquire)) {
    std::this_thread::sleep_for(kLook);
    meanwhile();
  }
  thread.join();
  if (failure) {
    std::rethrow_exception(failure);
  }
  return setup;
}

}  // namespace patella::app
