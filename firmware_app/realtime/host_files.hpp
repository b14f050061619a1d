// The kernel's statements under /proc, /sys and /dev.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patella::app {

/// Reads below `root`, which is "/" but for tests. Files that are absent or unreadable give nothing.
class HostFiles {
 public:
  explicit HostFiles(std::filesystem::path root = "/") : root_(std::move(root)) {}

  /// `path` without the leading slash.
  std::filesystem::path path(std::string_view path) const { return root_ / path; }
  /// First line, without its end.
  std::optional<std::string> line(std::string_view path) const;
  std::optional<std::string> text(std::string_view path) const;

  /// From /sys/kernel/realtime, or where a kernel lacks that file from the version text.
  bool preemptRt() const;
  /// Frequency governors of all processors, each once, sorted; empty where none is visible.
  std::vector<std::string> governors() const;
  /// Processors named by a list file such as sys/devices/system/cpu/isolated.
  std::vector<int> cpuList(std::string_view path) const;
  bool writable(std::string_view path) const;
  bool exists(std::string_view path) const;

 private:
  std::filesystem::path root_;
};

/// "0,2-4" to 0, 2, 3, 4; empty for an empty, "(null)" or malformed list.
std::vector<int> parseCpuList(std::string_view list);
std::string formatCpuList(const std::vector<int>& cpus);
/// True for a capability of this process that is in force, see capabilities(7).
bool hasCapability(int capability);

}  // namespace patella::app
