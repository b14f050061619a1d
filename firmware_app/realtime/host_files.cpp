#include "firmware_app/realtime/host_files.hpp"

#include <charconv>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include <unistd.h>

#include "drivers/joined.hpp"

namespace patella::app {

std::optional<std::string> HostFiles::text(std::string_view relative) const {
  std::ifstream file(path(relative));
  if (!file) {
    return std::nullopt;
  }
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

std::optional<std::string> HostFiles::line(std::string_view relative) const {
  std::ifstream file(path(relative));
  std::string first;
  if (!file || (!std::getline(file, first) && first.empty() && !file.eof())) {
    return std::nullopt;
  }
  return first;
}

bool HostFiles::preemptRt() const {
  // Vendors' kernels lack the file, mainline (since 6.12) lacks it too: both print PREEMPT_RT in the version.
  return line("sys/kernel/realtime") == "1" ||
         line("proc/version").value_or("").find("PREEMPT_RT") != std::string::npos;
}

std::vector<std::string> HostFiles::governors() const {
  std::set<std::string> seen;
  for (int cpu = 0; exists("sys/devices/system/cpu/cpu" + std::to_string(cpu)); ++cpu) {
    if (auto governor =
            line("sys/devices/system/cpu/cpu" + std::to_string(cpu) + "/cpufreq/scaling_governor")) {
      seen.insert(*std::move(governor));
    }
  }
  return {seen.begin(), seen.end()};
}

std::vector<int> HostFiles::cpuList(std::string_view relative) const {
  return parseCpuList(line(relative).value_or(""));
}

bool HostFiles::writable(std::string_view relative) const {
  return access(path(relative).c_str(), W_OK) == 0;
}

bool HostFiles::exists(std::string_view relative) const {
  std::error_code ignored;
  return std::filesystem::exists(path(relative), ignored);
}

std::vector<int> parseCpuList(std::string_view list) {
  std::vector<int> cpus;
  const char* at = list.data();
  const char* const end = at + list.size();
  while (at < end) {
    int first = 0;
    auto read = std::from_chars(at, end, first);
    int last = first;
    if (read.ec == std::errc{} && read.ptr < end && *read.ptr == '-') {
      read = std::from_chars(read.ptr + 1, end, last);
    }
    if (read.ec != std::errc{} || (read.ptr < end && *read.ptr != ',')) {
      return {};
    }
    for (int cpu = first; cpu <= last; ++cpu) {
      cpus.push_back(cpu);
    }
    at = read.ptr + 1;
  }
  return cpus;
}

std::string formatCpuList(const std::vector<int>& cpus) {
  return cpus.empty() ? "none" : joined(cpus, ",", [](int cpu) { return std::to_string(cpu); });
}

bool hasCapability(int capability) {
  std::istringstream status(HostFiles().text("proc/self/status").value_or(""));
  for (std::string word; status >> word;) {
    if (word == "CapEff:") {
      std::uint64_t mask = 0;
      status >> std::hex >> mask;
      return (mask >> capability & 1U) != 0;
    }
  }
  return false;
}

}  // namespace patella::app
