// A stack for the signal handlers of a thread. sigaltstack(2) is of one thread: where a thread has none, a
// stack that overflows ends the process before any handler can run.
#pragma once

#include <csignal>
#include <cstddef>
#include <functional>
#include <thread>

namespace patella {

/// Memory for one thread's handlers: present from the start, locked where mlockall(2) locks all, and with a
/// page below it that nobody may touch.
class SignalStack {
 public:
  /// Throws std::system_error when the memory cannot be had.
  SignalStack();
  ~SignalStack();
  SignalStack(SignalStack&& other) noexcept;
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

  /// While it lives, handlers set with SA_ONSTACK run on the stack in the thread that made this object; after
  /// it on the one before.
  class InUse {
   public:
    explicit InUse(const SignalStack& stack) noexcept;
    ~InUse();
    InUse(const InUse&) = delete;
    InUse& operator=(const InUse&) = delete;

   private:
    stack_t before_{};
  };

 private:
  void* block_ = nullptr;
  std::size_t guard_bytes_ = 0;
  std::size_t usable_bytes_ = 0;
};

/// A thread with a signal stack of its own, which leaves to others what is sent to the process: how every
/// thread of a loop's process is started. Throws std::system_error when thread or stack cannot be had.
std::thread startThread(std::function<void()> work);

}  // namespace patella
