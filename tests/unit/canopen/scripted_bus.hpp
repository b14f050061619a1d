// A bus on which a function answers, for nodes that say what a test wants them to say.
#pragma once

#include <deque>
#include <functional>
#include <initializer_list>
#include <vector>

#include "drivers/can/bus.hpp"

namespace patella::test {

inline can::Frame makeFrame(std::uint32_t id, std::initializer_list<unsigned> bytes) {
  can::Frame frame;
  frame.id = id;
  for (const unsigned byte : bytes)
    frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

class ScriptedBus final : public can::Bus {
 public:
  std::size_t receive(std::span<can::Frame> frames, std::int64_t /*now_ns*/) noexcept override {
    std::size_t count = 0;
    while (count < frames.size() && !waiting.empty()) {
      frames[count++] = waiting.front();
      waiting.pop_front();
    }
    return count;
  }
  can::SendResult send(can::Frame& frame, std::int64_t /*now_ns*/) noexcept override {
    if (result == can::SendResult::kSent) {
      sent.push_back(frame);
      if (answer)
        answer(frame, waiting);
    }
    return result;
  }
  bool down() const noexcept override { return false; }
  can::BusStatistics statistics() const noexcept override { return {}; }

  std::function<void(const can::Frame&, std::deque<can::Frame>&)> answer;
  std::deque<can::Frame> waiting;
  std::vector<can::Frame> sent;
  can::SendResult result = can::SendResult::kSent;
};

}  // namespace patella::test
