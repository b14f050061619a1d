// Simulated CANopen drives on a bus of their own, in virtual time.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "drivers/can/bus.hpp"
#include "drivers/canopen/canopen_map.hpp"
#include "drivers/clock/clock.hpp"
#include "sim/field_drive.hpp"

namespace patella::test {

/// They are sampled once a millisecond, when somebody looks at the bus.
class DriveBench final : public can::Bus {
 public:
  explicit DriveBench(const std::vector<sim::FieldDriveOptions>& options) {
    for (const sim::FieldDriveOptions& one : options)
      drives.push_back(sim::makeFieldDrive(one));
  }

  std::size_t receive(std::span<can::Frame> frames, std::int64_t now_ns) noexcept override {
    live(now_ns);
    std::size_t count = 0;
    while (count < frames.size() && !sink.waiting.empty()) {
      frames[count++] = sink.waiting.front();
      sink.waiting.pop_front();
    }
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept override {
    live(now_ns);
    sent.push_back(frame);
    if (!keep_back || !keep_back(frame)) {
      for (const auto& drive : drives)
        drive->accept(frame, joint, now_ns, sink);
    }
    return can::SendResult::kSent;
  }
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

  void live(std::int64_t now_ns) noexcept {
    for (; next_ns <= now_ns; next_ns += 1'000'000) {
      for (const auto& drive : drives) {
        drive->watch(next_ns);
        drive->sample(joint, next_ns, sink);
      }
    }
  }

  class Sink final : public sim::FrameSink {
   public:
    void put(const can::Frame& frame) noexcept override { waiting.push_back(frame); }
    std::deque<can::Frame> waiting;
  };
  std::vector<std::unique_ptr<sim::FieldDrive>> drives;
  sim::JointReading joint;
  Sink sink;
  std::vector<can::Frame> sent;
  std::function<bool(const can::Frame&)> keep_back;
  std::int64_t next_ns = 0;
};

inline sim::FieldDriveOptions simulatedNode(int node) {
  return {.kind = sim::FieldDriveKind::kCia402,
          .id = node,
          .torque_limit_Nm = 100.0,
          .rated_torque_Nm = 0.5,
          .gear = 100.0};
}

inline canopen::DriveSettings settingsOf(const sim::FieldDriveOptions& options, int joint) {
  return {.joint = joint,
          .node = options.id,
          .rated_torque_Nm = options.rated_torque_Nm,
          .rated_torque_unit_Nm = options.rated_torque_unit_Nm,
          .gear = options.gear,
          .direction = options.direction,
          .counts_per_turn = options.counts_per_turn,
          .zero_angle_rad = options.zero_angle_rad};
}

}  // namespace patella::test
