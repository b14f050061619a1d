// The part of a fault script that takes the machine's own memory and disk away.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include <sys/resource.h>

#include "sim/fault_script.hpp"

namespace patella::app {

/// memory_pressure holds that much memory, all of it written to, as far as the machine has it beyond
/// kSpare_MB. disk_full makes every write to a file fail: the process' limit of file size (setrlimit(2)) is
/// zero meanwhile, which needs no rights and no other disk. Works on a thread of its own, which looks at the
/// script each millisecond, in virtual time too; nothing is started where the script has no such fault.
class HostStress {
 public:
  static constexpr std::size_t kSpare_MB = 256;

  /// `time_s` gives the time of the script to any thread, and outlives this.
  HostStress(const std::vector<sim::FaultEvent>& events, std::function<double()> time_s);
  /// Gives back what it holds.
  ~HostStress();
  HostStress(const HostStress&) = delete;
  HostStress& operator=(const HostStress&) = delete;

 private:
  void work();
  void hold(double wanted_MB);
  void closeDisk(bool closed);

  std::vector<sim::FaultEvent> events_;
  std::function<double()> time_s_;
  std::vector<void*> chunks_;
  rlimit before_{};
  bool closed_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace patella::app
