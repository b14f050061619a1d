#include "firmware_app/realtime/interrupt_findings.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>

namespace patella::app {
namespace {

namespace fs = std::filesystem;

/// Names of the entries of a folder that are plain numbers: /proc/irq, /proc.
std::vector<std::string> numberedEntries(const HostFiles& host, std::string_view folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(host.path(folder), ignored)) {
    const std::string name = entry.path().filename().string();
    if (std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; })) {
      names.push_back(name);
    }
  }
  return names;
}

/// An interrupt that somebody handles has a folder of the handler's name, see proc(5).
bool hasHandler(const HostFiles& host, const std::string& irq_folder) {
  std::error_code ignored;
  const fs::directory_iterator entries(host.path(irq_folder), ignored);
  return std::any_of(begin(entries), end(entries), [](const fs::directory_entry& entry) {
    std::error_code unreadable;
    return entry.is_directory(unreadable);
  });
}

Finding affinityFinding(const HostNeeds& needs, const HostFiles& host) {
  int handled = 0;
  int on_loop = 0;
  for (const std::string& irq : numberedEntries(host, "proc/irq")) {
    const std::string folder = "proc/irq/" + irq;
    if (!hasHandler(host, folder)) {
      continue;
    }
    ++handled;
    const std::vector<int> cpus = host.cpuList(folder + "/smp_affinity_list");
    on_loop += std::any_of(needs.cpus.begin(), needs.cpus.end(),
                           [&](int cpu) { return std::find(cpus.begin(), cpus.end(), cpu) != cpus.end(); })
                   ? 1
                   : 0;
  }
  const bool bound = !needs.cpus.empty();
  const std::string where = bound ? formatCpuList(needs.cpus) : "the loop's processor";
  const bool ok = bound && on_loop == 0;
  return {"irq_affinity",
          ok,
          false,
          std::to_string(bound ? on_loop : handled) + " of " + std::to_string(handled) +
              " interrupts may run on " + where,
          "0",
          ok      ? ""
          : bound ? "boot with irqaffinity= and the other processors, and stop irqbalance"
                  : "bind the loop to a processor, then keep interrupts off it with irqaffinity="};
}

/// Priority of the thread that serves the interface's interrupts, from /proc/PID/stat; nothing without one.
std::optional<int> interruptThreadPriority(const HostFiles& host, const std::string& interface) {
  std::error_code ignored;
  // Controllers on a serial bus name the interrupt after the device: irq/50-spi0.0.
  const std::string device =
      fs::canonical(host.path("sys/class/net/" + interface + "/device"), ignored).filename().string();
  constexpr int kFieldsBeforePriority = 37;  // of those behind the name; rt_priority is field 40
  for (const std::string& process : numberedEntries(host, "proc")) {
    const std::string stat = host.line("proc/" + process + "/stat").value_or("");
    const std::size_t open = stat.find("(irq/");
    const std::size_t close = stat.rfind(')');
    if (open == std::string::npos || close == std::string::npos || close < open) {
      continue;
    }
    const std::size_t dash = stat.find('-', open);
    const std::string name = dash < close ? stat.substr(dash + 1, close - dash - 1) : std::string();
    if (name.empty() || (name != interface && name != device)) {
      continue;
    }
    std::istringstream fields(stat.substr(close + 1));
    std::string skipped;
    for (int i = 0; i < kFieldsBeforePriority; ++i) {
      fields >> skipped;
    }
    int priority = 0;
    if (fields >> priority) {
      return priority;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<Finding> interruptFindings(const HostNeeds& needs, const HostFiles& host) {
  std::vector<Finding> findings{affinityFinding(needs, host)};
  for (const CanNeed& need : needs.can) {
    const auto priority = interruptThreadPriority(host, need.interface);
    if (!priority) {
      continue;
    }
    const bool ok = *priority > needs.priority;
    const std::string which = needs.can.size() > 1 ? need.interface + ": " : "";
    findings.push_back({"can_irq_priority", ok, false, which + std::to_string(*priority),
                        "above " + std::to_string(needs.priority) + ", the loop's",
                        ok ? ""
                           : "chrt -f -p " + std::to_string(needs.priority + 5) + " the thread irq/N-" +
                                 need.interface + " (ps -eo pid,rtprio,comm | grep irq/)"});
  }
  return findings;
}

}  // namespace patella::app
