#include "firmware_app/realtime/host_readiness.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include <linux/can/netlink.h>
#include <linux/capability.h>
#include <sys/resource.h>
#include <unistd.h>

#include "drivers/joined.hpp"
#include "firmware_app/realtime/interrupt_findings.hpp"

namespace patella::app {

namespace {

constexpr bool kRequired = true;
constexpr bool kAdvised = false;

Finding finding(std::string name, bool required, bool ok, std::string found, std::string expected,
                std::string fix) {
  return {std::move(name), ok, required, std::move(found), std::move(expected), ok ? "" : std::move(fix)};
}

Finding indispensable(Finding finding) {
  finding.indispensable = true;
  return finding;
}

std::string limitText(rlim_t limit) {
  return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit);
}

Finding kernelFinding(const HostFiles& host) {
  const bool rt = host.preemptRt();
  return finding("preempt_rt", kRequired, rt, rt ? "PREEMPT_RT" : "no PREEMPT_RT", "a PREEMPT_RT kernel",
                 "install linux-image-rt-amd64 or linux-image-rt-arm64 and boot it");
}

Finding rtprioFinding(int priority) {
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  const bool capable = hasCapability(CAP_SYS_NICE);
  const bool ok = capable || limit.rlim_cur >= static_cast<rlim_t>(priority);
  return finding("rtprio_limit", kRequired, ok,
                 limitText(limit.rlim_cur) + (capable ? " and CAP_SYS_NICE" : ""),
                 "at least " + std::to_string(priority) + ", or CAP_SYS_NICE",
                 "add '@realtime - rtprio " + std::to_string(priority) +
                     "' to /etc/security/limits.d/realtime.conf and log in as a member of that group");
}

Finding memlockFinding() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  const bool capable = hasCapability(CAP_IPC_LOCK);
  const bool ok = capable || limit.rlim_cur == RLIM_INFINITY;
  return finding("memlock_limit", kRequired, ok,
                 limitText(limit.rlim_cur) + (capable ? " and CAP_IPC_LOCK" : ""),
                 "unlimited, or CAP_IPC_LOCK",
                 "add '@realtime - memlock unlimited' to /etc/security/limits.d/realtime.conf");
}

Finding governorFinding(const HostFiles& host) {
  const std::vector<std::string> governors = host.governors();
  const bool ok = std::all_of(governors.begin(), governors.end(),
                              [](const std::string& governor) { return governor == "performance"; });
  return finding("governor", kAdvised, ok,
                 governors.empty() ? "no frequency scaling" : joined(governors, ", "), "performance",
                 "cpupower frequency-set -g performance");
}

Finding cpuListFinding(const HostFiles& host, const HostNeeds& needs, const std::string& name,
                       const std::string& file, const std::string& parameter) {
  const std::vector<int> listed = host.cpuList("sys/devices/system/cpu/" + file);
  const bool bound = !needs.cpus.empty();
  const bool ok = bound && std::all_of(needs.cpus.begin(), needs.cpus.end(), [&](int cpu) {
                    return std::find(listed.begin(), listed.end(), cpu) != listed.end();
                  });
  const std::string wanted = bound ? formatCpuList(needs.cpus) : "the loop's processor";
  return finding(name, kAdvised, ok, formatCpuList(listed), wanted,
                 bound ? "boot with " + parameter + "=" + wanted
                       : "bind the loop to a processor, then boot with " + parameter);
}

Finding processorsFinding(const HostFiles& host, const HostNeeds& needs) {
  const std::vector<int> online = host.cpuList("sys/devices/system/cpu/online");
  const bool ok = std::all_of(needs.cpus.begin(), needs.cpus.end(), [&](int cpu) {
    return std::find(online.begin(), online.end(), cpu) != online.end();
  });
  return finding("processors", kRequired, ok, formatCpuList(online),
                 needs.cpus.empty() ? "any" : formatCpuList(needs.cpus),
                 "name processors that are online in realtime.cpus");
}

Finding dmaLatencyFinding(const HostFiles& host) {
  const bool ok = host.writable("dev/cpu_dma_latency");
  const bool there = host.exists("dev/cpu_dma_latency");
  return finding("cpu_dma_latency", kAdvised, ok,
                 ok      ? "writable"
                 : there ? "not writable"
                         : "absent",
                 "writable",
                 "give the group access with a udev rule: KERNEL==\"cpu_dma_latency\", GROUP=\"realtime\", "
                 "MODE=\"0660\"");
}

Finding throttlingFinding(const HostFiles& host) {
  constexpr long kDefaultRuntime_us = 950000;
  const std::string found = host.line("proc/sys/kernel/sched_rt_runtime_us").value_or("absent");
  const long runtime = found == "absent" ? -1 : std::strtol(found.c_str(), nullptr, 10);
  return finding("sched_rt_runtime_us", kAdvised, runtime == -1 || runtime >= kDefaultRuntime_us, found,
                 "-1, or at least 950000", "sysctl -w kernel.sched_rt_runtime_us=-1");
}

Finding swapFinding(const HostFiles& host) {
  const std::string swaps = host.text("proc/swaps").value_or("");
  const auto lines = std::count(swaps.begin(), swaps.end(), '\n');
  return finding("swap", kAdvised, lines <= 1, lines <= 1 ? "off" : "on", "off", "swapoff -a");
}

Finding clockSourceFinding(const HostFiles& host) {
  constexpr std::array<std::string_view, 4> kFast{"tsc", "arch_sys_counter", "kvm-clock",
                                                  "riscv_clocksource"};
  const std::string found =
      host.line("sys/devices/system/clocksource/clocksource0/current_clocksource").value_or("unknown");
  return finding("clock_source", kAdvised, std::find(kFast.begin(), kFast.end(), found) != kFast.end(), found,
                 "tsc or arch_sys_counter, read without a system call",
                 "see why the kernel gave up its counter: dmesg | grep -i clocksource");
}

Finding fdFinding(const CanNeed& need, const CanInterface& interface) {
  const std::string link = "ip link set " + need.interface;
  return indispensable(
      finding("can_fd", kRequired, interface.fd, interface.fd ? "CAN FD" : "classic frames only",
              "CAN FD, for message '" + need.fd_message + "' of the bus map",
              interface.kind == "vcan" ? link + " down; " + link + " mtu 72 up"
                                       : link + " down; " + link +
                                             " up type can dbitrate RATE fd on, with a controller "
                                             "that has it"));
}

void addCanFindings(std::vector<Finding>& findings, const HostNeeds& needs) {
  const bool kernel = kernelHasCan();
  findings.push_back(
      indispensable(finding("can_kernel", kRequired, kernel, kernel ? "present" : "absent", "raw CAN sockets",
                            "modprobe can-raw, or use a kernel built with CONFIG_CAN_RAW")));
  for (const CanNeed& need : needs.can) {
    for (Finding one : interfaceFindings(need, queryCanInterface(need.interface))) {
      one.found = needs.can.size() > 1 ? need.interface + ": " + one.found : one.found;
      findings.push_back(one);
    }
  }
}

Finding gpioFinding(const HostNeeds& needs) {
  const char* const path = needs.gpio_chip.c_str();
  const bool there = access(path, F_OK) == 0;
  const bool ok = there && access(path, R_OK | W_OK) == 0;
  return indispensable(finding("gpio_chip", kRequired, ok,
                               needs.gpio_chip + (ok      ? ""
                                                  : there ? " is not accessible"
                                                          : " does not exist"),
                               needs.gpio_chip + ", readable and writable",
                               there ? "join the group that owns it (ls -l " + needs.gpio_chip + ")"
                                     : "name one of the chips that gpiodetect lists"));
}

}  // namespace

std::vector<Finding> interfaceFindings(const CanNeed& need, const std::optional<CanInterface>& interface) {
  std::vector<Finding> findings;
  const std::string& name = need.interface;
  const bool there = interface && interface->can;
  findings.push_back(
      indispensable(finding("can_interface", kRequired, there,
                            there       ? name + " (" + interface->kind + ")"
                            : interface ? name + " is no CAN interface"
                                        : name + " does not exist",
                            name, "connect the adapter, or name another interface (ip -br link)")));
  if (!there) {
    return findings;
  }
  findings.push_back(indispensable(finding("can_up", kRequired, interface->up, interface->up ? "up" : "down",
                                           "up", "ip link set " + name + " up")));
  if (interface->state) {
    const bool healthy = *interface->state == CAN_STATE_ERROR_ACTIVE;
    findings.push_back(
        finding("can_state", kRequired, healthy,
                healthy ? "error active" : "state " + std::to_string(*interface->state), "error active",
                "check wiring and termination, then ip link set " + name + " down, and up again"));
  }
  if (need.bitrate != 0 && interface->kind == "can") {
    const std::string rate = std::to_string(need.bitrate);
    findings.push_back(finding(
        "can_bitrate", kRequired, interface->bitrate == need.bitrate, std::to_string(interface->bitrate),
        rate, "ip link set " + name + " down; ip link set " + name + " up type can bitrate " + rate));
  }
  if (!need.fd_message.empty()) {
    findings.push_back(fdFinding(need, *interface));
  }
  if (interface->kind == "can") {
    const std::string restart = std::to_string(interface->restart_ms);
    findings.push_back(finding(
        "can_restart_ms", kAdvised, interface->restart_ms != 0, restart, "not 0: back from bus-off by itself",
        "ip link set " + name + " down; ip link set " + name + " up type can restart-ms 100"));
  }
  findings.push_back(finding("can_txqueuelen", kRequired, interface->txqueuelen <= kLongestCanQueue,
                             std::to_string(interface->txqueuelen),
                             "at most " + std::to_string(kLongestCanQueue),
                             "ip link set " + name + " txqueuelen " + std::to_string(kLongestCanQueue)));
  return findings;
}

std::vector<Finding> hostReadiness(const HostNeeds& needs, const HostFiles& host) {
  std::vector<Finding> findings{
      kernelFinding(host),
      rtprioFinding(needs.priority),
      memlockFinding(),
      governorFinding(host),
      processorsFinding(host, needs),
      cpuListFinding(host, needs, "isolated_cpus", "isolated", "isolcpus"),
      cpuListFinding(host, needs, "nohz_full", "nohz_full", "nohz_full"),
      dmaLatencyFinding(host),
      throttlingFinding(host),
      swapFinding(host),
      clockSourceFinding(host),
  };
  const std::vector<Finding> interrupts = interruptFindings(needs, host);
  findings.insert(findings.end(), interrupts.begin(), interrupts.end());
  if (!needs.can.empty()) {
    addCanFindings(findings, needs);
  }
  if (!needs.gpio_chip.empty()) {
    findings.push_back(gpioFinding(needs));
  }
  return findings;
}

}  // namespace patella::app
