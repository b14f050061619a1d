#include "sim/rig_thread.hpp"

#include <algorithm>

#include <pthread.h>

#include "drivers/signal_stack.hpp"

namespace patella::sim {
namespace {

constexpr std::size_t kFramesToLoop = 4096;
constexpr std::size_t kFramesToRig = 256;

}  // namespace

RigThread::RigThread(Rig& rig, Clock& clock, int priority)
    : rig_(rig),
      clock_(clock),
      priority_(priority),
      wall_offset_ns_(clock.wallNow() - clock.now()),
      to_loop_(kFramesToLoop),
      to_rig_(kFramesToRig) {}

void RigThread::start() {
  if (thread_.joinable()) {
    return;
  }
  running_.store(true, std::memory_order_relaxed);
  try {
    thread_ = startThread([this] { run(); });
  } catch (...) {
    running_.store(false, std::memory_order_relaxed);
    throw;
  }
}

void RigThread::stop() noexcept {
  running_.store(false, std::memory_order_relaxed);
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::size_t RigThread::receive(std::span<can::Frame> frames,
                               std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  errors_.beginReceive();
  std::size_t count = 0;
  while (count < frames.size() && to_loop_.pop(frames[count])) {
    can::Frame& frame = frames[count++];
    frame.wall_ns = frame.monotonic_ns + wall_offset_ns_;
    frame.age_ns = std::max<std::int64_t>(now_ns - frame.monotonic_ns, 0);
    frame.monotonic_ns = now_ns;
    errors_.observe(frame, statistics_[frame.bus]);
    statistics_[frame.bus].frames_received += frame.error ? 0U : 1U;
  }
  return count;
}

can::SendResult RigThread::send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING {
  if ((downBuses() & can::busBit(frame.bus)) != 0) {
    ++statistics_[frame.bus].send_failed;
    return can::SendResult::kDown;
  }
  frame.monotonic_ns = now_ns;
  frame.wall_ns = now_ns + wall_offset_ns_;
  if (!to_rig_.push(frame)) {
    ++statistics_[frame.bus].send_failed;
    return can::SendResult::kQueueFull;
  }
  ++statistics_[frame.bus].frames_sent;
  return can::SendResult::kSent;
}

can::BusStatistics RigThread::statistics() const noexcept {
  can::BusStatistics statistics = statistics_.total();
  statistics.receive_dropped = dropped_.load(std::memory_order_relaxed);
  return statistics;
}

void RigThread::run() noexcept {
  if (priority_ > 0) {
    sched_param parameters{};
    parameters.sched_priority = priority_;
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  }
  const std::int64_t period_ns = rig_.sensorPeriod_ns();
  std::int64_t instant_ns = (clock_.now() / period_ns + 1) * period_ns;
  rig_.advance(instant_ns);
  can::Frame frame;
  while (running_.load(std::memory_order_relaxed)) {
    clock_.sleepUntil(instant_ns);
    while (to_rig_.pop(frame)) {
      rig_.advance(std::min(frame.monotonic_ns, instant_ns));
      rig_.accept(frame);
    }
    rig_.advance(instant_ns);
    while (rig_.pop(frame)) {
      if (!to_loop_.push(frame)) {
        dropped_.fetch_add(1, std::memory_order_relaxed);
      }
    }
    instant_ns += period_ns;
  }
}

}  // namespace patella::sim
