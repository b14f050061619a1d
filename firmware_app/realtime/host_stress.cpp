#include "firmware_app/realtime/host_stress.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <sys/mman.h>

#include "drivers/signal_stack.hpp"

namespace patella::app {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20U;
constexpr std::size_t kChunk_MB = 16;
constexpr auto kPeriod = std::chrono::milliseconds(1);

// MemAvailable of proc_meminfo(5): what can be had without swapping.
bool plenty() {
  std::ifstream stream("/proc/meminfo");
  std::string key;
  std::size_t available_kB = 0;
  while (stream >> key) {
    if (key == "MemAvailable:") {
      stream >> available_kB;
      break;
    }
  }
  return available_kB > HostStress::kSpare_MB * 1024;
}

}  // namespace

HostStress::HostStress(const std::vector<sim::FaultEvent>& events, std::function<double()> time_s)
    : time_s_(std::move(time_s)) {
  std::copy_if(events.begin(), events.end(), std::back_inserter(events_),
               [](const sim::FaultEvent& event) { return sim::actsOnMachine(event.kind); });
  if (!events_.empty()) {
    getrlimit(RLIMIT_FSIZE, &before_);
    thread_ = startThread([this] { work(); });
  }
}

HostStress::~HostStress() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) {
    thread_.join();
  }
}

void HostStress::work() {
  while (!stop_.load(std::memory_order_relaxed)) {
    const double now_s = time_s_();
    double wanted_MB = 0.0;
    bool closed = false;
    for (const sim::FaultEvent& event : events_) {
      if (event.activeAt(now_s)) {
        wanted_MB += event.kind == sim::FaultKind::kMemoryPressure ? event.value : 0.0;
        closed = closed || event.kind == sim::FaultKind::kDiskFull;
      }
    }
    closeDisk(closed);
    hold(wanted_MB);
    std::this_thread::sleep_for(kPeriod);
  }
  closeDisk(false);
  hold(0.0);
}

// A chunk a call, so that the end of the script is not missed.
void HostStress::hold(double wanted_MB) {
  if (static_cast<double>(chunks_.size() * kChunk_MB) < wanted_MB) {
    void* chunk = plenty() ? mmap(nullptr, kChunk_MB * kMegabyte, PROT_READ | PROT_WRITE,
                                  MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                           : MAP_FAILED;
    if (chunk != MAP_FAILED) {
      std::memset(chunk, 1, kChunk_MB * kMegabyte);
      chunks_.push_back(chunk);
    }
  } else if (wanted_MB == 0.0) {
    for (void* chunk : chunks_) {
      munmap(chunk, kChunk_MB * kMegabyte);
    }
    chunks_.clear();
  }
}

void HostStress::closeDisk(bool closed) {
  if (closed != closed_) {
    closed_ = closed;
    const rlimit limit{closed ? 0 : before_.rlim_cur, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
}

}  // namespace patella::app
