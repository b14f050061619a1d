// Bytes as frames through decoder and tick: nothing may break what is said of torque. Each tick takes a byte
// that says how many frames come and whether the host has found a fault, then 11 bytes a frame: which
// message, what is done to it, length, and data. Every other stream begins with a loop that is active.
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "drivers/can/crc8.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/support/tick_under_test.hpp"
#include "tools/checkout/checkout.hpp"

namespace {

using namespace patella;

constexpr std::array<std::uint32_t, 8> kIdentifiers = {0x80, 0xA0, 0x110, 0x111, 0x120, 0x130, 0x7E0, 0x123};
constexpr std::size_t kFrameBytes = 11;

const app::RunConfig& configuration() {
  static const app::RunConfig config = [] {
    app::CommandLine line;
    line.config = patella::checkout::source() / "firmware_app/config/adult.toml";
    app::RunConfig loaded = app::loadRunConfig(line);
    loaded.tick.healthy_ticks = 5;
    loaded.rig.operator_buttons.enable_at_s = 0.02;
    return loaded;
  }();
  return config;
}

class Stream {
 public:
  Stream()
      : rig_(app::makeRig(configuration())),
        encoder_(app::makeEncoder(configuration())),
        tick_(configuration()) {}

  /// A tick of the genuine rig, with what else there is.
  void step(std::vector<can::Frame> extra, safety::FaultSet host, bool genuine) {
    rig_->advance(tick_.now_ns());
    can::Frame frame;
    std::vector<can::Frame> frames;
    while (rig_->pop(frame)) {
      frame.wall_ns = frame.monotonic_ns;
      if (genuine) {
        frames.push_back(frame);
      }
    }
    frames.insert(frames.end(), extra.begin(), extra.end());
    const char* broken = tick_.step(frames, host);
    fuzz::require(broken == nullptr, broken == nullptr ? "" : broken);
    const bool active = tick_.state() == safety::State::kActive;
    rig_->accept(encoder_.encode({tick_.torque_Nm(), active, static_cast<std::uint8_t>(tick_.state())}));
  }

 private:
  std::unique_ptr<sim::Rig> rig_;
  can::CommandEncoder encoder_;
  test::TickUnderTest tick_;
};

can::Frame frameOf(const std::uint8_t* bytes) {
  can::Frame frame;
  frame.id = kIdentifiers[bytes[0] & 7U];
  frame.length = static_cast<std::uint8_t>(bytes[1] & 15U);
  frame.error = (bytes[1] & 0x40U) != 0 && (bytes[1] & 0x20U) != 0;
  frame.fd = (bytes[1] & 0x10U) != 0;
  std::copy_n(bytes + 3, 8, frame.data.begin());
  if ((bytes[1] & 0x80U) != 0) {
    frame.length = 8;
    frame.data[7] = can::frameCrc(frame, 7);
  }
  frame.wall_ns = static_cast<std::int64_t>(bytes[2]) * 1'000'000;
  return frame;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) {
    return 0;
  }
  Stream stream;
  for (int i = 0; (data[0] & 1U) != 0 && i < 60; ++i) {
    stream.step({}, {}, true);
  }
  for (std::size_t at = 1; at < size;) {
    const std::uint8_t head = data[at++];
    safety::FaultSet host;
    if ((head & 0xF8U) == 0xF8U && at < size) {
      host.add(static_cast<safety::Fault>(data[at++] % safety::kFaultCount));
    }
    std::vector<can::Frame> frames;
    for (unsigned i = 0; i < (head & 3U) && at + kFrameBytes <= size; ++i, at += kFrameBytes) {
      frames.push_back(frameOf(data + at));
    }
    stream.step(frames, host, (head & 4U) == 0);
  }
  return 0;
}
