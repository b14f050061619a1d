#include "firmware_app/realtime/realtime_setup.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "firmware_app/realtime/page_faults.hpp"
#include "tests/support/scratch_folder.hpp"

namespace {

using namespace patella::app;
namespace fs = std::filesystem;

/// Asks for nothing that outlives the thread.
RealtimeOptions quiet() {
  RealtimeOptions options;
  options.priority = 0;
  options.lock_memory = false;
  options.prefault_stack_bytes = 0;
  options.prefault_heap_bytes = 0;
  options.cpu_dma_latency_us = -1;
  return options;
}

/// Scheduling and affinity die with the thread that got them.
template <typename Work>
void onOwnThread(const Work& work) {
  std::thread thread(work);
  thread.join();
}

const Finding* find(const RealtimeReport& report, const std::string& name) {
  for (const Finding& one : report.findings) {
    if (one.name == name) {
      return &one;
    }
  }
  return nullptr;
}

struct Host {
  Host() { fs::create_directories(path / "dev"); }
  patella::test::ScratchFolder folder;
  fs::path path = folder.path();
};

}  // namespace

TEST_CASE("the report says what the kernel says") {
  onOwnThread([] {
    RealtimeOptions options = quiet();
    options.priority = 10;
    const RealtimeSetup setup(options);
    const RealtimeReport& report = setup.report();
    sched_param parameters{};
    sched_getparam(0, &parameters);
    const bool fifo = sched_getscheduler(0) == SCHED_FIFO;
    CHECK((report.policy == "SCHED_FIFO") == fifo);
    CHECK(report.priority == parameters.sched_priority);
    REQUIRE(find(report, "scheduling") != nullptr);
    CHECK(find(report, "scheduling")->ok == (fifo && parameters.sched_priority == 10));
    CHECK(find(report, "scheduling")->fix.empty() == find(report, "scheduling")->ok);
    CHECK(report.timer_slack_ns == prctl(PR_GET_TIMERSLACK));
    CHECK(report.preempt_rt == HostFiles().preemptRt());
    CHECK(report.degraded() == !allRequiredOk(report.findings));
  });
}

TEST_CASE("the thread is bound to the processors asked for") {
  onOwnThread([] {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    REQUIRE(sched_getaffinity(0, sizeof allowed, &allowed) == 0);
    int first = 0;
    while (!CPU_ISSET(first, &allowed)) {
      ++first;
    }
    RealtimeOptions options = quiet();
    options.cpus = {first};
    const RealtimeSetup setup(options);
    CHECK(sched_getcpu() == first);
    CHECK(setup.report().cpus == std::vector<int>{first});
    CHECK(find(setup.report(), "affinity")->ok);
  });
}

std::vector<int> allowedCpus() {
  cpu_set_t set;
  CPU_ZERO(&set);
  REQUIRE(sched_getaffinity(0, sizeof set, &set) == 0);
  std::vector<int> cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(cpu, &set)) {
      cpus.push_back(cpu);
    }
  }
  return cpus;
}

TEST_CASE("threads beside the loop keep off its processors, where there are others") {
  onOwnThread([] {
    const std::vector<int> before = allowedCpus();
    keepOff({});
    CHECK(allowedCpus() == before);
    keepOff(before);
    CHECK(allowedCpus() == before);
    if (before.size() > 1) {
      keepOff({before.front()});
      CHECK(allowedCpus() == std::vector<int>(before.begin() + 1, before.end()));
    } else {
      WARN_MESSAGE(before.size() > 1, "one processor: that others are kept off it cannot be seen here");
    }
  });
}

TEST_CASE("a processor that this process may not use is refused, and those that it may are named") {
  const std::vector<int> usable = usableProcessors();
  REQUIRE_FALSE(usable.empty());
  const std::vector<int> allowed = allowedCpus();
  CHECK(std::includes(usable.begin(), usable.end(), allowed.begin(), allowed.end()));
  CHECK(allowedCpus() == allowed);  // asking binds nobody
  CHECK_NOTHROW(requireUsable(usable));
  CHECK_NOTHROW(requireUsable({}));
  onOwnThread([&] {
    RealtimeOptions options = quiet();
    options.cpus = {usable.front(), CPU_SETSIZE - 1};  // no machine of ours has as many
    CHECK_THROWS_WITH_AS(
        RealtimeSetup{options},
        ("realtime.cpus: processor 1023, expected one that this process may use: " + formatCpuList(usable))
            .c_str(),
        std::invalid_argument);
  });
}

TEST_CASE("the wake-up latency is asked for and held until the object goes") {
  const Host host;
  std::ofstream(host.path / "dev/cpu_dma_latency").close();
  onOwnThread([&] {
    RealtimeOptions options = quiet();
    options.cpu_dma_latency_us = 7;
    const auto held = [&] {
      for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
        std::error_code gone;
        if (fs::read_symlink(entry.path(), gone) == host.path / "dev/cpu_dma_latency") {
          return true;
        }
      }
      return false;
    };
    {
      const RealtimeSetup setup(options, HostFiles(host.path));
      CHECK(setup.report().cpu_dma_latency_held);
      CHECK(held());
    }
    CHECK_FALSE(held());
    std::int32_t written = 0;
    std::ifstream(host.path / "dev/cpu_dma_latency", std::ios::binary)
        .read(reinterpret_cast<char*>(&written), sizeof written);
    CHECK(written == 7);

    fs::remove(host.path / "dev/cpu_dma_latency");
    const RealtimeSetup setup(options, HostFiles(host.path));
    CHECK_FALSE(setup.report().cpu_dma_latency_held);
    CHECK_FALSE(find(setup.report(), "cpu_dma_latency")->ok);
  });
}

TEST_CASE("require_rt refuses a machine without PREEMPT_RT and says what to do") {
  const Host host;
  fs::create_directories(host.path / "proc");
  std::ofstream(host.path / "proc/version") << "Linux version 6.1.0 #1 SMP PREEMPT_DYNAMIC\n";
  std::ofstream(host.path / "dev/cpu_dma_latency").close();
  onOwnThread([&] {
    RealtimeOptions options = quiet();
    options.require_rt = true;
    options.cpu_dma_latency_us = 0;
    std::string message;
    try {
      const RealtimeSetup setup(options, HostFiles(host.path));
    } catch (const std::runtime_error& error) {
      message = error.what();
    }
    CHECK(message.find("preempt_rt") != std::string::npos);
    CHECK(message.find("linux-image-rt") != std::string::npos);
    CHECK(message.find("cpu_dma_latency") == std::string::npos);

    std::ofstream(host.path / "proc/version") << "Linux version 6.1.0 #1 SMP PREEMPT_RT\n";
    CHECK_NOTHROW(RealtimeSetup(options, HostFiles(host.path)));
  });
}

TEST_CASE("prefaulted heap takes no page faults when it is used") {
  onOwnThread([] {
    constexpr std::size_t kBytes = 4 * 1024 * 1024;
    const auto faultsOfUse = [] {
      const ThreadUsage before = ThreadUsage::ofThisThread();
      auto* block = static_cast<volatile char*>(std::malloc(kBytes));
      for (std::size_t i = 0; i < kBytes; i += 4096) {
        block[i] = 1;
      }
      const ThreadUsage after = ThreadUsage::ofThisThread();
      std::free(const_cast<char*>(block));
      return after.minor_faults - before.minor_faults;
    };
    const std::uint64_t fresh = faultsOfUse();
    RealtimeOptions options = quiet();
    options.prefault_heap_bytes = 2 * kBytes;
    options.prefault_stack_bytes = 128 * 1024;
    const RealtimeSetup setup(options);
#if !defined(PATELLA_SANITIZER_address) && !defined(PATELLA_SANITIZER_thread)
    CHECK(fresh > 0);
    CHECK(faultsOfUse() <= fresh / 64);  // the kernel may take a resident page away for a moment
#else
    CHECK(fresh > 0);
#endif
  });
}

TEST_CASE("options out of range are refused by name") {
  const auto message = [](const RealtimeOptions& options) -> std::string {
    try {
      const RealtimeSetup setup(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  RealtimeOptions options = quiet();
  options.priority = 99;
  CHECK(message(options) == "realtime.priority = 99, expected 0 to 98");
  options = quiet();
  options.cpus = {-1};
  CHECK(message(options).find("processor -1") != std::string::npos);
  options = quiet();
  options.prefault_stack_bytes = std::size_t{1} << 40U;
  CHECK(message(options).find("prefault_stack_bytes") != std::string::npos);
}
