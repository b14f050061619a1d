#include "tools/bench/latency/frame_latency.hpp"

#include <algorithm>
#include <stdexcept>

namespace patella::bench {
FrameLatency::FrameLatency(const app::BusDescription& bus)
    : command_(bus.database.message(bus.commands.back().message).id) {
  for (const can::Binding& binding : bus.map.bindings) {
    if (binding.input.starts_with("position_rad.")) {
      sensors_.push_back(bus.database.message(binding.message).id);
    }
  }
  if (sensors_.empty()) {
    throw std::invalid_argument("no message carries position_rad, expected one for each joint");
  }
}

void FrameLatency::add(const can::Frame& frame) noexcept {
  if (frame.error || frame.remote) {
    return;
  }
  if (frame.id == command_) {
    if (sensed_) {
      latency_.add(frame.wall_ns - sensed_ns_);
    } else {
      ++unanswering_;
    }
    sensed_ = false;
  } else if (std::find(sensors_.begin(), sensors_.end(), frame.id) != sensors_.end()) {
    sensed_ns_ = frame.wall_ns;
    sensed_ = true;
  }
}

}  // namespace patella::bench
