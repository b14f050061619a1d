#include "firmware_app/realtime/realtime_setup.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "core/bounds/bounds.hpp"
#include "drivers/joined.hpp"
#include "drivers/signal_stack.hpp"

namespace patella::app {

namespace {

constexpr std::size_t kStackStep = 16 * 1024;
constexpr std::size_t kStackReserve = 64 * 1024;  // what the loop itself goes on to use below this frame
constexpr std::size_t kPage = 4096;

std::size_t stackLeft() {
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) {
    return 0;
  }
  void* lowest = nullptr;
  std::size_t size = 0;
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  return reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0)) -
         reinterpret_cast<std::uintptr_t>(lowest);
}

void checkOptions(const RealtimeOptions& options) {
  requireBound(boundOf("realtime.priority"), options.priority);
  requireUsable(options.cpus);
  const std::size_t left = stackLeft();
  if (options.prefault_stack_bytes + kStackReserve > left) {
    throw std::invalid_argument("prefault_stack_bytes " + std::to_string(options.prefault_stack_bytes) +
                                ": this thread has " + std::to_string(left) + " bytes of stack left");
  }
}

/// Each call takes a further step of stack; the read after the inner call keeps it from becoming a loop.
__attribute__((noinline)) void touchStack(std::size_t bytes) {
  volatile char frame[kStackStep];
  for (std::size_t i = 0; i < kStackStep; i += kPage) {
    frame[i] = 1;
  }
  if (bytes > kStackStep) {
    touchStack(bytes - kStackStep);
  }
  static_cast<void>(frame[0]);
}

void touchHeap(std::size_t bytes) {
  // Keep what was touched: give nothing back to the kernel, and serve large blocks from the same heap.
  mallopt(M_TRIM_THRESHOLD, -1);  // NOLINT(concurrency-mt-unsafe): set-up, once
  mallopt(M_MMAP_MAX, 0);         // NOLINT(concurrency-mt-unsafe): set-up, once
  auto* const block = static_cast<volatile char*>(std::malloc(bytes));
  if (block == nullptr) {
    return;
  }
  for (std::size_t i = 0; i < bytes; i += kPage) {
    block[i] = 1;
  }
  std::free(const_cast<char*>(block));
}

int holdDmaLatency(const HostFiles& host, std::int32_t latency_us) {
  // The request stands while the descriptor is open, Documentation/power/pm_qos_interface.
  const int fd = open(host.path("dev/cpu_dma_latency").c_str(), O_WRONLY | O_CLOEXEC);
  if (fd >= 0 && write(fd, &latency_us, sizeof latency_us) != sizeof latency_us) {
    close(fd);
    return -1;
  }
  return fd;
}

const char* policyName(int policy) {
  switch (policy & ~SCHED_RESET_ON_FORK) {
    case SCHED_FIFO:
      return "SCHED_FIFO";
    case SCHED_RR:
      return "SCHED_RR";
    case SCHED_OTHER:
      return "SCHED_OTHER";
    case SCHED_BATCH:
      return "SCHED_BATCH";
    case SCHED_IDLE:
      return "SCHED_IDLE";
    default:
      return "other";
  }
}

void bindTo(const cpu_set_t& set) noexcept {
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

std::vector<int> affinity() {
  std::vector<int> cpus;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (pthread_getaffinity_np(pthread_self(), sizeof set, &set) == 0) {
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      if (CPU_ISSET(cpu, &set)) {
        cpus.push_back(cpu);
      }
    }
  }
  return cpus;
}

std::vector<Finding> judge(const RealtimeReport& report, const RealtimeOptions& options) {
  std::vector<Finding> findings;
  const auto add = [&](std::string name, bool required, bool ok, std::string found, std::string expected,
                       std::string fix) {
    findings.push_back(
        {std::move(name), ok, required, std::move(found), std::move(expected), ok ? "" : std::move(fix)});
  };
  add("preempt_rt", true, report.preempt_rt, report.preempt_rt ? "PREEMPT_RT" : "no PREEMPT_RT",
      "a PREEMPT_RT kernel", "install linux-image-rt-amd64 or linux-image-rt-arm64 and boot it");
  if (options.priority > 0) {
    add("scheduling", true, report.policy == "SCHED_FIFO" && report.priority == options.priority,
        report.policy + " " + std::to_string(report.priority),
        "SCHED_FIFO " + std::to_string(options.priority),
        "raise the rtprio limit to " + std::to_string(options.priority) + ", or grant CAP_SYS_NICE");
  }
  if (options.lock_memory) {
    add("memory_lock", true, report.memory_locked, report.memory_locked ? "locked" : "not locked", "locked",
        "raise the memlock limit to unlimited, or grant CAP_IPC_LOCK");
  }
  if (!options.cpus.empty()) {
    std::vector<int> wanted = options.cpus;
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    add("affinity", true, report.cpus == wanted, formatCpuList(report.cpus), formatCpuList(wanted),
        "name processors that are online and in this process's cpuset");
    const bool isolated =
        std::includes(report.isolated_cpus.begin(), report.isolated_cpus.end(), wanted.begin(), wanted.end());
    add("isolated_cpus", false, isolated, formatCpuList(report.isolated_cpus), formatCpuList(wanted),
        "boot with isolcpus=" + formatCpuList(wanted));
  }
  if (options.cpu_dma_latency_us >= 0) {
    add("cpu_dma_latency", true, report.cpu_dma_latency_held,
        report.cpu_dma_latency_held ? "held" : "not held",
        "held at " + std::to_string(options.cpu_dma_latency_us) + " us",
        "make /dev/cpu_dma_latency writable for this user");
  }
  add("governor", false, report.governor == "performance" || report.governor == "none", report.governor,
      "performance", "cpupower frequency-set -g performance");
  return findings;
}

}  // namespace

void keepOff(const std::vector<int>& cpus) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (cpus.empty() || pthread_getaffinity_np(pthread_self(), sizeof set, &set) != 0) {
    return;
  }
  for (const int cpu : cpus) {
    CPU_CLR(cpu, &set);
  }
  if (CPU_COUNT(&set) > 0) {
    bindTo(set);
  }
}

std::vector<int> usableProcessors() {
  std::vector<int> usable;
  // The mask in force may be narrower: isolated processors are in nobody's until he asks for them. The kernel
  // cuts down what is asked for; a thread that ends then is not bound by it.
  startThread([&usable] {
    cpu_set_t all;
    CPU_ZERO(&all);
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      CPU_SET(cpu, &all);
    }
    bindTo(all);
    usable = affinity();
  }).join();
  return usable;
}

void requireUsable(const std::vector<int>& cpus) {
  const std::vector<int> usable = cpus.empty() ? cpus : usableProcessors();
  for (const int cpu : cpus) {
    if (std::find(usable.begin(), usable.end(), cpu) == usable.end()) {
      throw std::invalid_argument("realtime.cpus: processor " + std::to_string(cpu) +
                                  ", expected one that this process may use: " + formatCpuList(usable));
    }
  }
}

RealtimeSetup::RealtimeSetup(const RealtimeOptions& options, const HostFiles& host) {
  checkOptions(options);
  apply(options, host);
  readBack(options, host);
  if (options.require_rt && report_.degraded()) {
    std::string missing = "real time is required, but this machine falls short:";
    for (const Finding& one : report_.findings) {
      if (!one.ok && one.required) {
        missing += "\n  " + one.name + ": " + one.found + ", expected " + one.expected + "; " + one.fix;
      }
    }
    if (dma_latency_fd_ >= 0) {
      close(dma_latency_fd_);
    }
    throw std::runtime_error(missing);
  }
}

RealtimeSetup::~RealtimeSetup() {
  if (dma_latency_fd_ >= 0) {
    close(dma_latency_fd_);
  }
}

void RealtimeSetup::apply(const RealtimeOptions& options, const HostFiles& host) {
  if (options.lock_memory) {
    memory_locked_ = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  }
  touchHeap(options.prefault_heap_bytes);
  touchStack(options.prefault_stack_bytes);
  if (options.cpu_dma_latency_us >= 0) {
    dma_latency_fd_ = holdDmaLatency(host, options.cpu_dma_latency_us);
  }
  // Real-time threads have no slack; without that class, the default 50 us would be added to each wake-up.
  prctl(PR_SET_TIMERSLACK, 1UL);
  if (!options.cpus.empty()) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int cpu : options.cpus) {
      CPU_SET(cpu, &set);
    }
    bindTo(set);
  }
  if (options.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options.priority;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  }
}

void RealtimeSetup::readBack(const RealtimeOptions& options, const HostFiles& host) {
  // Not pthread_getschedparam(): it answers from what the library remembers.
  sched_param parameters{};
  sched_getparam(0, &parameters);
  report_.policy = policyName(sched_getscheduler(0));
  report_.priority = parameters.sched_priority;
  report_.memory_locked = memory_locked_;
  report_.cpus = affinity();
  report_.cpu_dma_latency_held = dma_latency_fd_ >= 0;
  report_.preempt_rt = host.preemptRt();
  const std::vector<std::string> governors = host.governors();
  report_.governor = governors.empty() ? "none" : joined(governors, ", ");
  report_.isolated_cpus = host.cpuList("sys/devices/system/cpu/isolated");
  report_.timer_slack_ns = prctl(PR_GET_TIMERSLACK);
  report_.findings = judge(report_, options);
}

std::string RealtimeReport::summary() const {
  std::string text = policy + " " + std::to_string(priority) + ", memory " +
                     (memory_locked ? "locked" : "not locked") + ", processors " + formatCpuList(cpus) +
                     " (isolated: " + formatCpuList(isolated_cpus) + "), governor " + governor +
                     ", cpu_dma_latency " + (cpu_dma_latency_held ? "held" : "not held") + ", " +
                     (preempt_rt ? "PREEMPT_RT" : "no PREEMPT_RT") + ", timer slack " +
                     std::to_string(timer_slack_ns) + " ns";
  return text + (degraded() ? "; DEGRADED" : "");
}

}  // namespace patella::app
