// Preloaded into User-mode Linux. Its 6.1 kernel saves and restores the floating-point registers of its
// processes through a buffer sized for AVX-512; the host kernel refuses to restore less than the whole
// register state (xstateregs_set() in arch/x86/kernel/fpu/regset.c: -EFAULT), which is larger on processors
// with AMX. Here the rest is completed from what the traced process has.
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

constexpr std::uintptr_t kExtendedStateNote = 0x202;  // NT_X86_XSTATE, elf.h
constexpr std::size_t kLargestState = 1U << 16U;

long restoreExtendedState(pid_t pid, std::uintptr_t note, const iovec& given) {
  alignas(64) static thread_local std::array<std::byte, kLargestState> whole;
  iovec all{whole.data(), whole.size()};
  const long read = syscall(SYS_ptrace, PTRACE_GETREGSET, pid, note, &all);
  if (read < 0 || all.iov_len <= given.iov_len) {
    return syscall(SYS_ptrace, PTRACE_SETREGSET, pid, note, &given);
  }
  std::memcpy(whole.data(), given.iov_base, given.iov_len);
  return syscall(SYS_ptrace, PTRACE_SETREGSET, pid, note, &all);
}

}  // namespace

extern "C" long ptrace(enum __ptrace_request request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  const pid_t pid = va_arg(arguments, pid_t);
  const std::uintptr_t address = va_arg(arguments, std::uintptr_t);
  void* data = va_arg(arguments, void*);
  va_end(arguments);
  if (request == PTRACE_SETREGSET && address == kExtendedStateNote) {
    return restoreExtendedState(pid, address, *static_cast<const iovec*>(data));
  }
  // The system call stores what a peek found where `data` points; ptrace(2) returns it.
  long peeked = 0;
  const bool peeks = request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER;
  const long result = syscall(SYS_ptrace, request, pid, address, peeks ? static_cast<void*>(&peeked) : data);
  if (!peeks || result < 0) {
    return result;
  }
  errno = 0;
  return peeked;
}
