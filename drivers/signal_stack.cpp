#include "drivers/signal_stack.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <sys/auxv.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/process_signals.hpp"

namespace patella {
namespace {

constexpr std::size_t kForHandlers = 64 * 1024;

}  // namespace

SignalStack::SignalStack() : guard_bytes_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))) {
  // The kernel puts all registers there first, which with wide vectors are many (getauxval(3)).
  const std::size_t for_registers = getauxval(AT_MINSIGSTKSZ);
  usable_bytes_ = (kForHandlers + for_registers + guard_bytes_ - 1) / guard_bytes_ * guard_bytes_;
  void* const block = mmap(nullptr, guard_bytes_ + usable_bytes_, PROT_READ | PROT_WRITE,
                           MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK | MAP_POPULATE, -1, 0);
  if (block == MAP_FAILED) {
    throw std::system_error(errno, std::generic_category(), "a signal stack");
  }
  block_ = block;
  mprotect(block, guard_bytes_, PROT_NONE);
}

SignalStack::~SignalStack() {
  if (block_ != nullptr) {
    munmap(block_, guard_bytes_ + usable_bytes_);
  }
}

SignalStack::SignalStack(SignalStack&& other) noexcept
    : block_(std::exchange(other.block_, nullptr)),
      guard_bytes_(other.guard_bytes_),
      usable_bytes_(other.usable_bytes_) {}

SignalStack::InUse::InUse(const SignalStack& stack) noexcept {
  stack_t mine{};
  mine.ss_sp = static_cast<char*>(stack.block_) + stack.guard_bytes_;
  mine.ss_size = stack.usable_bytes_;
  sigaltstack(&mine, &before_);
}

SignalStack::InUse::~InUse() {
  sigaltstack(&before_, nullptr);
}

std::thread startThread(std::function<void()> work) {
  const ProcessSignalsLeft left;
  return std::thread([stack = SignalStack(), work = std::move(work)] {
    const SignalStack::InUse in_use(stack);
    work();
  });
}

}  // namespace patella
