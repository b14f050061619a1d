#include "tools/bench/tick/counter.hpp"

#include <cerrno>
#include <ctime>
#include <system_error>

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace patella::bench {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

int openInstructionCounter() {
  perf_event_attr attributes{};
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.size = sizeof attributes;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  const long descriptor = syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC);
  if (descriptor < 0) {
    throw std::system_error(errno, std::generic_category(),
                            "no counter of instructions (kernel.perf_event_paranoid, virtual machine)");
  }
  return static_cast<int>(descriptor);
}

}  // namespace

Counter::Counter(Unit unit)
    : unit_(unit), descriptor_(unit == Unit::kInstructions ? openInstructionCounter() : -1) {}

Counter::~Counter() {
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
}

std::int64_t Counter::read() const noexcept {
  if (descriptor_ >= 0) {
    std::int64_t count = 0;
    return ::read(descriptor_, &count, sizeof count) == static_cast<ssize_t>(sizeof count) ? count : 0;
  }
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNanoseconds + now.tv_nsec;
}

}  // namespace patella::bench
