// Random streams of frames, right, damaged, forged and made up, through decoder and tick.
#include <cstdlib>
#include <filesystem>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "drivers/can/crc8.hpp"
#include "sim/rig.hpp"
#include "tests/support/tick_under_test.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;

namespace {

app::RunConfig demonstration() {
  app::CommandLine line;
  line.config = checkout::source() / "firmware_app/config/adult.toml";
  line.clock = "virtual";
  app::RunConfig config = app::loadRunConfig(line);
  config.tick.healthy_ticks = 10;
  config.rig.operator_buttons.enable_at_s = 0.03;
  return config;
}

/// The bus between the rig and the loop.
class Vandal {
 public:
  Vandal(std::uint64_t seed, double badness) : random_(seed), badness_(badness) {}

  bool chance(double probability) {
    return std::uniform_real_distribution<>(0.0, 1.0)(random_) < probability;
  }
  std::uint64_t draw(std::uint64_t count) { return random_() % count; }

  void damage(std::vector<can::Frame>& frames) {
    std::vector<can::Frame> left;
    for (can::Frame frame : frames) {
      if (chance(badness_)) {
        spoil(frame, left);
      } else {
        left.push_back(frame);
      }
    }
    if (left.size() > 1 && chance(badness_)) {
      std::swap(left[draw(left.size())], left[draw(left.size())]);
    }
    if (!left.empty()) {
      kept_ = left.back();
    }
    frames = left;
  }

 private:
  void spoil(can::Frame frame, std::vector<can::Frame>& left) {
    switch (draw(6)) {
      case 0:
        return;  // lost
      case 1:
        left.push_back(frame);
        left.push_back(frame);
        return;
      case 2:  // noise
        frame.data[draw(8)] ^= static_cast<std::uint8_t>(1U << draw(8));
        break;
      case 3:  // forged: anything at all, with a right CRC
        for (std::size_t i = 0; i < 6; ++i) {
          frame.data[i] = static_cast<std::uint8_t>(random_());
        }
        if (chance(0.3)) {
          frame.data[6] = static_cast<std::uint8_t>(random_());
        }
        frame.data[7] = can::frameCrc(frame, 7);
        break;
      case 4:  // short, long, of another kind
        frame.length = static_cast<std::uint8_t>(draw(65));
        frame.error = chance(0.2);
        frame.remote = chance(0.2);
        frame.extended = chance(0.2);
        break;
      default:
        left.push_back(frame);
        frame = kept_;  // from before
        break;
    }
    left.push_back(frame);
  }

  std::mt19937_64 random_;
  double badness_;
  can::Frame kept_;
};

/// Ticks with torque in a stream of so many.
int run(const app::RunConfig& base, std::uint64_t seed, double badness, int ticks) {
  CAPTURE(seed);
  CAPTURE(badness);
  app::RunConfig config = base;
  config.rig.seed = seed;
  Vandal vandal(seed, badness);
  for (int i = 0; i < ticks / 200; ++i) {
    config.rig.operator_buttons.reset_at_s.push_back(0.2 * i + 0.05);
  }
  const auto rig = app::makeRig(config);
  const auto encoder = std::make_unique<can::CommandEncoder>(app::makeEncoder(config));
  test::TickUnderTest tick(config);
  std::vector<can::Frame> frames;
  int with_torque = 0;
  for (int k = 0; k < ticks; ++k) {
    rig->advance(tick.now_ns());
    frames.clear();
    can::Frame frame;
    while (rig->pop(frame)) {
      frame.wall_ns = frame.monotonic_ns;
      // The operator works for real: presses and lets go.
      if (frame.id == 160 && (k / 100) % 2 == 1) {
        frame.data[0] = static_cast<std::uint8_t>(frame.data[0] & ~1U);
        frame.data[7] = can::frameCrc(frame, 7);
      }
      frames.push_back(frame);
    }
    vandal.damage(frames);
    safety::FaultSet host;
    if (vandal.chance(0.001)) {
      host.add(static_cast<safety::Fault>(vandal.draw(safety::kFaultCount)));
    }
    const char* broken = tick.step(frames, host);
    if (broken != nullptr) {
      FAIL(broken);
    }
    Command command{tick.torque_Nm(), tick.state() == safety::State::kActive,
                    static_cast<std::uint8_t>(tick.state())};
    with_torque += command.enable ? 1 : 0;
    rig->accept(encoder->encode(command));
  }
  return with_torque;
}

}  // namespace

TEST_CASE("for every stream: finite, within limit and rate, zero at a fault, no way back without an edge") {
  const app::RunConfig config = demonstration();
  // Chosen anew each time, and told when it fails.
  const std::uint64_t seed = std::random_device{}();
  int with_torque = 0;
  for (std::uint64_t i = 0; i < 12; ++i) {
    for (const double badness : {0.0005, 0.005, 0.05, 0.5}) {
      with_torque += run(config, seed + i, badness, 1000);
    }
  }
  CHECK(with_torque > 200);  // else nothing was at stake
}
