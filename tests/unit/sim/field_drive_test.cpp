// Drives that are nodes of their own: their frames byte by byte, their states, watchdogs and defects.
#include "sim/field_drive.hpp"

#include <array>
#include <bit>
#include <stdexcept>
#include <vector>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::sim;

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

class Collected final : public FrameSink {
 public:
  Collected() { frames.reserve(16); }  // a drive answers in real time
  void put(const can::Frame& frame) noexcept override { frames.push_back(frame); }
  const can::Frame* find(std::uint32_t id) const {
    for (const can::Frame& frame : frames) {
      if (frame.id == id)
        return &frame;
    }
    return nullptr;
  }
  std::vector<can::Frame> frames;
};

can::Frame make(std::uint32_t id, std::initializer_list<unsigned> bytes) {
  can::Frame frame;
  frame.id = id;
  for (const unsigned byte : bytes)
    frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

can::Frame inputTorque(std::uint32_t node, float torque_Nm) {
  const auto word = std::bit_cast<std::uint32_t>(torque_Nm);
  return make(node << 5U | 0x0EU, {word & 0xFFU, word >> 8U & 0xFFU, word >> 16U & 0xFFU, word >> 24U});
}

float floatAt(const can::Frame& frame, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i)
    word |= std::uint32_t{frame.data[at + i]} << (8U * i);
  return std::bit_cast<float>(word);
}

const can::Frame kEnter = make(1, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC});
const can::Frame kLeave = make(1, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD});
/// Middle of position, velocity and torque, no gains; then with torque at 3/4 of its bits.
const can::Frame kZero = make(1, {0x80, 0x00, 0x80, 0x00, 0x00, 0x00, 0x08, 0x00});
const can::Frame kHalf = make(1, {0x80, 0x00, 0x80, 0x00, 0x00, 0x00, 0x0C, 0x00});

/// A drive on its own bus, with a hand on its clock.
struct Bench {
  explicit Bench(const FieldDriveOptions& options) : drive(makeFieldDrive(options)) {}
  bool hear(const can::Frame& frame) { return drive->accept(frame, joint, now_ns, sent); }
  void wait(std::int64_t span_ns) {
    now_ns += span_ns;
    drive->watch(now_ns);
  }
  void sample() {
    sent.frames.clear();
    drive->sample(joint, now_ns, sent);
  }
  std::unique_ptr<FieldDrive> drive;
  JointReading joint;
  Collected sent;
  std::int64_t now_ns = kMillisecond;
};

FieldDriveOptions odrive() {
  return {.kind = FieldDriveKind::kOdrive, .id = 2, .torque_limit_Nm = 10.0};
}

}  // namespace

TEST_CASE("a motor in MIT mode answers whatever it hears, and obeys once it has entered") {
  Bench bench({.id = 1, .master_id = 5, .torque_range_Nm = 18.0, .torque_limit_Nm = 8.0});
  bench.joint = {12.5, -45.0};
  CHECK(bench.hear(kHalf));
  CHECK(bench.drive->torque() == 0.0);
  REQUIRE(bench.sent.frames.size() == 1);
  const can::Frame& reply = bench.sent.frames[0];
  CHECK(reply.id == 5);
  // Motor, position at its end, velocity at its beginning, torque in the middle, 25 °C, no error.
  const std::array<std::uint8_t, 8> expected = {1, 0xFF, 0xFF, 0x00, 0x08, 0x00, 25, 0};
  CHECK(std::equal(expected.begin(), expected.end(), reply.data.begin()));
  bench.sample();
  CHECK(bench.sent.frames.empty());

  bench.hear(kEnter);
  CHECK_FALSE(bench.drive->enabled());
  bench.wait(50 * kMillisecond);
  CHECK(bench.drive->enabled());
  bench.hear(kZero);
  CHECK(bench.drive->torque() == doctest::Approx(18.0 / 4095).epsilon(1e-6));
  bench.hear(kHalf);
  CHECK(bench.drive->torque() == 8.0);  // 9.01 asked for, and limited
  bench.wait(19 * kMillisecond);
  CHECK(bench.drive->torque() == 8.0);
  bench.wait(1 * kMillisecond);
  CHECK(bench.drive->torque() == 0.0);
  CHECK(bench.drive->watchdogTrips() == 1);
  bench.hear(kHalf);
  CHECK(bench.drive->torque() == 8.0);
  bench.hear(kLeave);
  CHECK_FALSE(bench.drive->enabled());
  CHECK(bench.drive->torque() == 0.0);
  CHECK_FALSE(bench.hear(make(2, {0, 0, 0, 0, 0, 0, 0, 0})));
}

TEST_CASE("bits at zero are full torque backwards, gains at work on top") {
  Bench bench({.id = 1, .velocity_range_rad_s = 45.0, .torque_limit_Nm = 1000.0, .enable_delay_s = 0.0});
  bench.hear(kEnter);
  bench.hear(make(1, {0x80, 0x00, 0x80, 0x00, 0x00, 0x00, 0x00, 0x00}));
  CHECK(bench.drive->torque() == -18.0);
  // Stiffness of all bits, 500 N·m/rad, towards 0.00019 rad.
  bench.joint.position_rad = -0.1;
  bench.hear(make(1, {0x80, 0x00, 0x80, 0x0F, 0xFF, 0x00, 0x08, 0x00}));
  CHECK(bench.drive->torque() == doctest::Approx(500.0 * (0.1 + 12.5 / 65535) + 18.0 / 4095));
}

TEST_CASE("an ODrive reports by itself, and its watchdog is an error that has to be cleared") {
  Bench bench(odrive());
  bench.joint = {3.14159265358979, -6.28318530717959};
  bench.sample();
  REQUIRE(bench.sent.find(0x49) != nullptr);
  CHECK(floatAt(*bench.sent.find(0x49), 0) == 0.5F);
  CHECK(floatAt(*bench.sent.find(0x49), 4) == -1.0F);
  REQUIRE(bench.sent.find(0x41) != nullptr);
  CHECK(bench.sent.find(0x41)->data[4] == 1);
  bench.now_ns += kMillisecond;
  bench.sample();
  CHECK(bench.sent.find(0x41) == nullptr);  // heartbeats each 10 ms
  CHECK(bench.hear(inputTorque(2, 3.5F)));
  CHECK(bench.drive->torque() == 0.0);
  CHECK(bench.hear(make(0x47, {8, 0, 0, 0})));
  bench.wait(50 * kMillisecond);
  bench.hear(inputTorque(2, 3.5F));
  CHECK(bench.drive->torque() == 3.5);
  bench.hear(inputTorque(2, -30.0F));
  CHECK(bench.drive->torque() == -10.0);
  bench.sample();
  CHECK(floatAt(*bench.sent.find(0x5C), 0) == -30.0F);
  CHECK(floatAt(*bench.sent.find(0x5C), 4) == -10.0F);
  CHECK(bench.sent.find(0x41)->data[4] == 8);

  bench.wait(20 * kMillisecond);
  CHECK(bench.drive->torque() == 0.0);
  CHECK_FALSE(bench.drive->enabled());
  bench.sample();
  CHECK(bench.sent.find(0x41)->data[3] == 1);  // error 01000000h
  bench.hear(make(0x47, {8, 0, 0, 0}));
  bench.wait(50 * kMillisecond);
  CHECK_FALSE(bench.drive->enabled());
  bench.hear(make(0x58, {0}));
  bench.hear(make(0x47, {8, 0, 0, 0}));
  bench.wait(50 * kMillisecond);
  CHECK(bench.drive->enabled());
  bench.hear(make(0x47, {1, 0, 0, 0}));
  CHECK_FALSE(bench.drive->enabled());
  CHECK_FALSE(bench.hear(inputTorque(1, 1.0F)));
}

TEST_CASE("defects: silent, deaf to enter, rebooting, faulty, leaving by itself") {
  FieldDriveOptions options = odrive();
  options.enable_delay_s = 0.0;
  Bench bench(options);
  bench.hear(make(0x47, {8, 0, 0, 0}));
  bench.hear(inputTorque(2, 3.5F));
  SUBCASE("silent: torque goes on") {
    bench.drive->defect({.silent = true}, bench.now_ns);
    bench.sample();
    CHECK(bench.sent.frames.empty());
    CHECK(bench.drive->torque() == 3.5);
  }
  SUBCASE("ignores enter") {
    bench.hear(make(0x47, {1, 0, 0, 0}));
    bench.drive->defect({.ignores_enter = true}, bench.now_ns);
    bench.hear(make(0x47, {8, 0, 0, 0}));
    CHECK_FALSE(bench.drive->enabled());
  }
  SUBCASE("reboots: says and hears nothing, and is disabled afterwards") {
    bench.drive->defect({.off = true}, bench.now_ns);
    bench.sample();
    CHECK(bench.sent.frames.empty());
    CHECK(bench.drive->torque() == 0.0);
    CHECK_FALSE(bench.hear(make(0x47, {8, 0, 0, 0})));
    bench.drive->defect({}, bench.now_ns);
    CHECK_FALSE(bench.drive->enabled());
    CHECK(bench.hear(make(0x47, {8, 0, 0, 0})));
    CHECK(bench.drive->enabled());
  }
  SUBCASE("reports a fault until it is cleared") {
    bench.drive->defect({.faulty = true}, bench.now_ns);
    bench.sample();
    CHECK(bench.drive->torque() == 0.0);
    CHECK(bench.sent.find(0x41)->data[2] == 2);
    bench.drive->defect({}, bench.now_ns);
    bench.hear(make(0x58, {0}));
    bench.now_ns += 10 * kMillisecond;
    bench.sample();
    CHECK(bench.sent.find(0x41)->data[2] == 0);
  }
  SUBCASE("leaves by itself, once") {
    bench.drive->defect({.leaves = true}, bench.now_ns);
    CHECK_FALSE(bench.drive->enabled());
    CHECK(bench.drive->torque() == 0.0);
  }
  SUBCASE("gives another torque than told") {
    bench.drive->defect({.gain = 0.5, .extra_Nm = 1.0}, bench.now_ns);
    CHECK(bench.drive->torque() == doctest::Approx(2.75));
  }
}

TEST_CASE("options out of range are refused by name") {
  CHECK_THROWS_WITH_AS(makeFieldDrive({.torque_range_Nm = 0.0}),
                       "drive model torque_range_Nm is 0.000000, expected > 0", std::invalid_argument);
  CHECK_THROWS_AS(makeFieldDrive({.watchdog_s = -1.0}), std::invalid_argument);
}
