#include "firmware_app/realtime/host_readiness.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "firmware_app/realtime/can_interface.hpp"
#include "tests/support/scratch_folder.hpp"

namespace {

using namespace patella::app;
namespace fs = std::filesystem;

/// A root folder with the kernel's files of a machine set up as it should be.
class FakeHost {
 public:
  FakeHost() {
    put("proc/version", "Linux version 6.1.0-26-rt-amd64 (gcc-12) #1 SMP PREEMPT_RT Debian 6.1.112-1\n");
    put("proc/swaps", "Filename\t\t\t\tType\t\tSize\t\tUsed\t\tPriority\n");
    put("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
    put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
    put("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n");
    put("sys/devices/system/cpu/online", "0-3\n");
    put("sys/devices/system/cpu/isolated", "1-3\n");
    put("sys/devices/system/cpu/nohz_full", "1,3\n");
    put("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
    put("dev/cpu_dma_latency", "");
    put("proc/irq/17/smp_affinity_list", "0,2\n");
    put("proc/irq/17/can0/x", "");
    put("proc/irq/18/smp_affinity_list", "0-3\n");  // without a handler
  }

  void put(const std::string& path, const std::string& text) const {
    fs::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
  void drop(const std::string& path) const { fs::remove(root_ / path); }
  HostFiles files() const { return HostFiles(root_); }

 private:
  patella::test::ScratchFolder folder_;
  fs::path root_ = folder_.path();
};

Finding named(const std::vector<Finding>& findings, const std::string& name) {
  const auto at =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.name == name; });
  REQUIRE_MESSAGE(at != findings.end(), name);
  return *at;
}

Finding check(const FakeHost& host, const std::string& name, const HostNeeds& needs = {}) {
  return named(hostReadiness(needs, host.files()), name);
}

HostNeeds boundTo(std::vector<int> cpus) {
  HostNeeds needs;
  needs.cpus = std::move(cpus);
  return needs;
}

}  // namespace

TEST_CASE("a well set-up machine passes, whatever this one's limits") {
  const FakeHost host;
  for (const Finding& one : hostReadiness(boundTo({1, 3}), host.files())) {
    if (one.name != "rtprio_limit" && one.name != "memlock_limit") {
      CHECK_MESSAGE(one.ok, one.name << ": " << one.found << ", expected " << one.expected);
      CHECK(one.fix.empty());
    }
  }
}

TEST_CASE("PREEMPT_RT is known by either sign") {
  const FakeHost host;
  CHECK(check(host, "preempt_rt").ok);
  host.put("proc/version", "Linux version 6.1.0-26-amd64 #1 SMP PREEMPT_DYNAMIC Debian 6.1.112-1\n");
  Finding one = check(host, "preempt_rt");
  CHECK_FALSE(one.ok);
  CHECK(one.required);
  CHECK(one.fix.find("linux-image-rt") != std::string::npos);
  host.put("sys/kernel/realtime", "1\n");
  CHECK(check(host, "preempt_rt").ok);
  host.put("sys/kernel/realtime", "0\n");
  CHECK_FALSE(check(host, "preempt_rt").ok);
}

TEST_CASE("one processor in another governor is enough to say so") {
  const FakeHost host;
  host.put("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "schedutil\n");
  const Finding one = check(host, "governor");
  CHECK_FALSE(one.ok);
  CHECK_FALSE(one.required);
  CHECK(one.found == "performance, schedutil");

  host.drop("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  host.drop("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor");
  CHECK(check(host, "governor").ok);
  CHECK(check(host, "governor").found == "no frequency scaling");
}

TEST_CASE("the loop's processors must all be isolated") {
  const FakeHost host;
  CHECK(check(host, "isolated_cpus", boundTo({1, 2})).ok);
  CHECK_FALSE(check(host, "nohz_full", boundTo({1, 2})).ok);
  CHECK(check(host, "nohz_full", boundTo({1, 2})).fix == "boot with nohz_full=1,2");
  CHECK_FALSE(check(host, "isolated_cpus", boundTo({0})).ok);
  CHECK(check(host, "processors", boundTo({1, 3})).ok);
  CHECK_FALSE(check(host, "processors", boundTo({1, 4})).ok);
  CHECK(check(host, "processors", boundTo({1, 4})).found == "0,1,2,3");
  CHECK_FALSE(check(host, "isolated_cpus").ok);  // bound to none, isolation serves nothing
  host.put("sys/devices/system/cpu/isolated", "\n");
  CHECK(check(host, "isolated_cpus", boundTo({1})).found == "none");
}

TEST_CASE("throttling, swap, clock source and wake-up latency are judged") {
  const FakeHost host;
  host.put("proc/sys/kernel/sched_rt_runtime_us", "500000\n");
  CHECK_FALSE(check(host, "sched_rt_runtime_us").ok);
  host.put("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
  CHECK(check(host, "sched_rt_runtime_us").ok);

  host.put("proc/swaps", "Filename Type Size Used Priority\n/dev/sda2 partition 976892 0 -2\n");
  CHECK_FALSE(check(host, "swap").ok);
  CHECK(check(host, "swap").fix == "swapoff -a");

  host.put("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n");
  CHECK_FALSE(check(host, "clock_source").ok);
  CHECK(check(host, "clock_source").found == "hpet");

  host.drop("dev/cpu_dma_latency");
  CHECK_FALSE(check(host, "cpu_dma_latency").ok);
  CHECK(check(host, "cpu_dma_latency").found == "absent");
}

TEST_CASE("limits are this process's own") {
  const FakeHost host;
  rlimit limit{};
  REQUIRE(getrlimit(RLIMIT_RTPRIO, &limit) == 0);
  constexpr int kSysNice = 23;
  HostNeeds needs;
  needs.priority = 99;
  const bool allowed = limit.rlim_cur >= 99 || hasCapability(kSysNice);
  CHECK(check(host, "rtprio_limit", needs).ok == allowed);
  CHECK(check(host, "rtprio_limit", needs).expected.find("99") != std::string::npos);
  // Root has every capability unless a container took some, nobody else has any unless given.
  CHECK(named(hostReadiness({}, host.files()), "memlock_limit").expected.find("unlimited") !=
        std::string::npos);
}

TEST_CASE("interfaces and chips are judged only when they are needed") {
  const FakeHost host;
  for (const Finding& one : hostReadiness({}, host.files())) {
    CHECK(one.name.rfind("can_", 0) == std::string::npos);
    CHECK(one.name != "gpio_chip");
  }
  HostNeeds needs;
  needs.can = {{.interface = "nosuchcan0", .bitrate = 0}};
  needs.gpio_chip = "/dev/no_such_gpiochip";
  const std::vector<Finding> findings = hostReadiness(needs, host.files());
  CHECK_FALSE(named(findings, "can_interface").ok);
  CHECK(named(findings, "can_interface").found == "nosuchcan0 does not exist");
  CHECK_FALSE(named(findings, "gpio_chip").ok);
  CHECK(named(findings, "gpio_chip").fix.find("gpiodetect") != std::string::npos);
  CHECK(named(findings, "can_kernel").ok == kernelHasCan());
  CHECK_FALSE(allRequiredOk(findings));
  CHECK_FALSE(allIndispensableOk(findings));
  CHECK(allIndispensableOk(hostReadiness({}, host.files())));

  needs.can = {{.interface = "lo", .bitrate = 0}};
  CHECK(named(hostReadiness(needs, host.files()), "can_interface").found == "lo is no CAN interface");
}

TEST_CASE("the kernel tells an interface's state") {
  const auto loopback = queryCanInterface("lo");
  REQUIRE(loopback.has_value());
  CHECK_FALSE(loopback->can);
  CHECK_FALSE(loopback->fd);
  std::ifstream flags_file("/sys/class/net/lo/flags");
  std::ifstream queue_file("/sys/class/net/lo/tx_queue_len");
  unsigned flags = 0;
  unsigned queue = 0;
  flags_file >> std::hex >> flags;
  queue_file >> queue;
  REQUIRE_FALSE(flags_file.fail());
  REQUIRE_FALSE(queue_file.fail());
  CHECK(loopback->up == ((flags & 1U) != 0));
  CHECK(loopback->txqueuelen == queue);
  CHECK_FALSE(queryCanInterface("nosuchcan0").has_value());
}

TEST_CASE("a bus map with messages in CAN FD needs an interface that takes them") {
  CanInterface interface;
  interface.up = interface.can = true;
  interface.kind = "can";
  interface.txqueuelen = kLongestCanQueue;
  const CanNeed need{.interface = "can0", .bitrate = 0, .fd_message = "Emg"};
  const Finding classic = named(interfaceFindings(need, interface), "can_fd");
  CHECK_FALSE(classic.ok);
  CHECK(classic.found == "classic frames only");
  CHECK(classic.expected == "CAN FD, for message 'Emg' of the bus map");
  CHECK_FALSE(allIndispensableOk(interfaceFindings(need, interface)));
  interface.fd = true;
  CHECK(named(interfaceFindings(need, interface), "can_fd").ok);
  interface.fd = false;
  CHECK(allIndispensableOk(interfaceFindings({.interface = "can0"}, interface)));
}

TEST_CASE("an interface that a motor may hear, or that does not exist, is none to rehearse on") {
  CHECK_THROWS_WITH_AS(
      requireVirtual("lo"),
      "loop.rehearsal = true on CAN interface lo, expected a virtual one (vcan): a rehearsal "
      "moves no motor",
      std::invalid_argument);
  CHECK_THROWS_AS(requireVirtual("nosuchcan0"), std::invalid_argument);
}

TEST_CASE("processor lists") {
  CHECK(parseCpuList("0,2-4,7") == std::vector<int>{0, 2, 3, 4, 7});
  CHECK(parseCpuList("5") == std::vector<int>{5});
  CHECK(parseCpuList("").empty());
  CHECK(parseCpuList("(null)").empty());
  CHECK(parseCpuList("1-").empty());
  CHECK(formatCpuList({1, 3}) == "1,3");
  CHECK(formatCpuList({}) == "none");
}

// Runs where the harness names an interface, such as vcan0 of the emulated kernels.
TEST_CASE("a virtual CAN interface is recognised" *
          doctest::skip(std::getenv("PATELLA_CAN_INTERFACE") == nullptr)) {
  const std::string name = std::getenv("PATELLA_CAN_INTERFACE");
  const auto interface = queryCanInterface(name);
  REQUIRE(interface.has_value());
  CHECK(interface->can);
  CHECK(interface->up);
  CHECK(interface->kind == "vcan");
  CHECK_NOTHROW(requireVirtual(name));
  CHECK(interface->fd);
  CHECK(interface->bitrate == 0);
  HostNeeds needs;
  needs.can = {{.interface = name, .bitrate = 1000000}};
  const std::vector<Finding> findings = hostReadiness(needs);
  CHECK(named(findings, "can_kernel").ok);
  CHECK(named(findings, "can_up").ok);
  CHECK(named(findings, "can_interface").found == name + " (vcan)");
}

TEST_CASE("interrupts on the loop's processor are counted, those without a handler are not") {
  const FakeHost host;
  CHECK(check(host, "irq_affinity", boundTo({1, 3})).ok);
  Finding one = check(host, "irq_affinity", boundTo({2}));
  CHECK_FALSE(one.ok);
  CHECK_FALSE(one.required);
  CHECK(one.found == "1 of 1 interrupts may run on 2");
  CHECK_FALSE(check(host, "irq_affinity").ok);
}

TEST_CASE("the CAN interface's interrupt thread has to come before the loop") {
  const FakeHost host;
  HostNeeds needs;
  needs.can = {{.interface = "can0", .bitrate = 0}};
  const auto absent = hostReadiness(needs, host.files());
  CHECK(std::none_of(absent.begin(), absent.end(),
                     [](const Finding& one) { return one.name == "can_irq_priority"; }));

  const std::string before =
      "99 (irq/17-can0) S 2 0 0 0 -1 2129984 0 0 0 0 0 0 0 0 -51 0 1 0 90 0 0 "
      "18446744073709551615 0 0 0 0 0 0 0 2147483647 0 0 0 0 17 0 ";
  host.put("proc/99/stat", before + "50 1 0 0 0 0 0 0 0 0 0 0 0\n");
  Finding one = check(host, "can_irq_priority", needs);
  CHECK_FALSE(one.ok);
  CHECK(one.found == "50");
  CHECK(one.expected == "above 80, the loop's");
  host.put("proc/99/stat", before + "85 1 0 0 0 0 0 0 0 0 0 0 0\n");
  CHECK(check(host, "can_irq_priority", needs).ok);
}
