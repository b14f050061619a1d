#include "tools/bench/latency/frame_latency.hpp"

#include <filesystem>

#include <doctest/doctest.h>

#include "tools/checkout/checkout.hpp"

namespace {

using namespace patella;

can::Frame frame(std::uint32_t id, std::int64_t wall_ns) {
  can::Frame one;
  one.id = id;
  one.wall_ns = wall_ns;
  return one;
}

TEST_CASE("a torque frame answers the newest sensor frame, once") {
  bench::FrameLatency latency(
      app::loadBusDescription(checkout::source() / "firmware_app/config/can/patella.toml"));
  constexpr std::uint32_t kEncoder1 = 272;
  constexpr std::uint32_t kEncoder2 = 273;
  constexpr std::uint32_t kEmg = 304;
  constexpr std::uint32_t kTorque = 128;
  latency.add(frame(kTorque, 5));  // nothing sensed yet
  latency.add(frame(kEncoder1, 10));
  latency.add(frame(kEncoder2, 12));
  latency.add(frame(kEmg, 30));
  latency.add(frame(kTorque, 42));
  latency.add(frame(kTorque, 50));
  can::Frame error = frame(kTorque, 60);
  error.error = true;
  latency.add(error);
  CHECK(latency.unanswering() == 2);
  CHECK(latency.latency().count() == 1);
  CHECK(latency.latency().maximum() == 30);
}

}  // namespace
