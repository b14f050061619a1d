// From the newest sensor frame on the bus to the torque frame that answers it, as a bystander sees both.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/can/can_frame.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/recorder/latency_histogram.hpp"

namespace patella::bench {

class FrameLatency {
 public:
  /// Sensor frames are those that carry a position. Throws std::invalid_argument naming what the map lacks.
  explicit FrameLatency(const app::BusDescription& bus);

  /// Frames in the order of their stamps. Commands that no new sensor frame came before are counted apart.
  void add(const can::Frame& frame) noexcept;

  const app::LatencyHistogram& latency() const noexcept { return latency_; }
  std::uint64_t unanswering() const noexcept { return unanswering_; }

 private:
  std::vector<std::uint32_t> sensors_;
  std::uint32_t command_ = 0;
  std::int64_t sensed_ns_ = 0;
  bool sensed_ = false;  ///< since the last command
  std::uint64_t unanswering_ = 0;
  app::LatencyHistogram latency_;
};

}  // namespace patella::bench
