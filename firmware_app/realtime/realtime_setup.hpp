// Turns the calling thread into a real-time one, as far as the machine lets it, and says how far that was.
#pragma once

#include <string>
#include <vector>

#include "firmware_app/realtime/finding.hpp"
#include "firmware_app/realtime/host_files.hpp"
#include "firmware_app/realtime/realtime_options.hpp"

namespace patella::app {

/// Binds the calling thread, and with it those that it will start, to processors other than these, where
/// there are others that it may use: what writes files or shows progress would make the loop wait there.
void keepOff(const std::vector<int>& cpus) noexcept;

/// Those that a thread of this process may be bound to: online, and in its cpuset.
std::vector<int> usableProcessors();

/// Throws std::invalid_argument naming the first of these that is not usable, and those that are.
void requireUsable(const std::vector<int>& cpus);

/// The achieved state, read back from the kernel.
struct RealtimeReport {
  std::string policy;  ///< "SCHED_FIFO", "SCHED_OTHER", …
  int priority = 0;
  bool memory_locked = false;
  std::vector<int> cpus;  ///< processors that the thread may run on
  bool cpu_dma_latency_held = false;
  bool preempt_rt = false;
  std::string governor;            ///< "performance", "powersave", a list, or "none"
  std::vector<int> isolated_cpus;  ///< of the machine
  long timer_slack_ns = 0;
  std::vector<Finding> findings;

  /// True when something required is missing.
  bool degraded() const { return !allRequiredOk(findings); }
  /// One line for the log or the screen.
  std::string summary() const;
};

/// Applies the options to the thread that constructs it. Memory locking and the processors' wake-up latency
/// hold for the process; the latter until the object goes. Scheduling and affinity stay with the thread.
class RealtimeSetup {
 public:
  /// Throws std::invalid_argument for options out of range; with require_rt, std::runtime_error that names
  /// everything missing with its remedy.
  explicit RealtimeSetup(const RealtimeOptions& options, const HostFiles& host = HostFiles());
  ~RealtimeSetup();
  RealtimeSetup(const RealtimeSetup&) = delete;
  RealtimeSetup& operator=(const RealtimeSetup&) = delete;

  const RealtimeReport& report() const noexcept { return report_; }

 private:
  void apply(const RealtimeOptions& options, const HostFiles& host);
  void readBack(const RealtimeOptions& options, const HostFiles& host);

  int dma_latency_fd_ = -1;
  bool memory_locked_ = false;
  RealtimeReport report_;
};

}  // namespace patella::app
