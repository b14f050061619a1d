#include "sim/frame_forger.hpp"

#include <string_view>

#include "drivers/can/crc8.hpp"

namespace patella::sim {
namespace {

struct ForgedMessage {
  std::string_view message;
  std::string_view signal;
};

constexpr std::array<ForgedMessage, kFrameChannelCount> kMessages = {{{"Encoder1", "Position"},
                                                                      {"Encoder2", "Position"},
                                                                      {"DriveStatus", "Torque1"},
                                                                      {"Emg", "Channel1"},
                                                                      {"Truth", "Fu1"},
                                                                      {"Operator", "Enable"},
                                                                      {"TorqueCommand", "Torque1"}}};

}  // namespace

FrameForger::FrameForger(const can::Database& database) {
  for (std::size_t i = 0; i < known_.size(); ++i) {
    const can::Message* message = database.find(kMessages[i].message);
    if (message == nullptr || message->find(kMessages[i].signal) == nullptr) {
      continue;
    }
    const bool guarded = message->find("Counter") != nullptr && message->find("Crc") != nullptr;
    can::Protection protection;
    if (guarded) {
      protection = {message->name, "Counter", "Crc"};
    }
    known_[i].layout.emplace(*message, protection);
    known_[i].slot = known_[i].layout->slot(kMessages[i].signal);
  }
}

void FrameForger::heard(const can::Frame& frame, FrameChannel channel) noexcept PATELLA_NONBLOCKING {
  Known& known = known_[static_cast<std::size_t>(channel)];
  known.newest = frame;
  known.heard = true;
}

std::optional<can::Frame> FrameForger::forge(FrameChannel channel, double value, bool counter_correct,
                                             bool crc_correct) noexcept PATELLA_NONBLOCKING {
  Known& known = known_[static_cast<std::size_t>(channel)];
  if (!known.layout || !known.heard) {
    return std::nullopt;
  }
  const can::CompiledMessage& layout = *known.layout;
  can::Frame frame = known.newest;
  layout.signal(known.slot).encode(frame, value);
  if (layout.counter() && counter_correct) {
    layout.counter()->setRawBits(frame, layout.counter()->rawBits(frame) + 1);
  }
  if (layout.crc()) {
    const unsigned right = can::frameCrc(frame, layout.crcByte());
    layout.crc()->setRawBits(frame, crc_correct ? right : right ^ 0xFFU);
  }
  return frame;
}

}  // namespace patella::sim
