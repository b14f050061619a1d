// A simulated CANopen drive: its frames byte by byte, its states, its torque in whole thousandths, and what
// makes it fall into a fault.
#include "sim/cia402_drive.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::sim;

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

class Collected final : public FrameSink {
 public:
  Collected() { frames.reserve(64); }  // a drive answers in real time
  void put(const can::Frame& frame) noexcept override { frames.push_back(frame); }
  std::vector<can::Frame> frames;
};

can::Frame make(std::uint32_t id, std::initializer_list<unsigned> bytes) {
  can::Frame frame;
  frame.id = id;
  for (const unsigned byte : bytes)
    frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

/// Node 7, rated 0.5 N·m behind a gear of 100, as the loop sets it up where not told otherwise.
struct Bench {
  explicit Bench(bool ready = true, int direction = 1)
      : drive(makeFieldDrive({.kind = FieldDriveKind::kCia402,
                              .id = 7,
                              .torque_limit_Nm = 60.0,
                              .watchdog_s = 0.004,
                              .enable_delay_s = 0.005,
                              .rated_torque_Nm = 0.5,
                              .gear = 100.0,
                              .direction = direction,
                              .counts_per_turn = 4096.0,
                              .zero_angle_rad = 0.5})) {
    wait(1);
    if (ready)
      setUp();
  }
  void setUp() {
    download(0x2F, 0x6060, 0, 10);
    download(0x2F, 0x60C2, 1, 1);
    download(0x2B, 0x1017, 0, 10);
    download(0x23, 0x1016, 1, 0x007F0014);
    map(0x1400, 0x1600, 0x207, {0x60400010, 0x60710010}, 255);
    map(0x1800, 0x1A00, 0x187, {0x60410010, 0x60770010, 0x60640020}, 1);
    hear(make(0x000, {0x01, 7}));
    hear(make(0x77F, {0x05}));
  }
  void map(unsigned communication, unsigned mapping, std::uint32_t id,
           std::initializer_list<std::uint32_t> objects, unsigned type) {
    download(0x23, communication, 1, 0x80000000 | id);
    download(0x2F, mapping, 0, 0);
    unsigned entry = 0;
    for (const std::uint32_t object : objects)
      download(0x23, mapping, ++entry, object);
    download(0x2F, mapping, 0, entry);
    download(0x2F, communication, 2, type);
    download(0x23, communication, 1, id);
  }
  /// Code of the abort; 0 where it was done.
  std::uint32_t download(unsigned command, unsigned index, unsigned sub, std::uint32_t value) {
    const can::Frame answer = ask(make(0x607, {command, index & 0xFFU, index >> 8U, sub, value & 0xFFU,
                                               value >> 8U & 0xFFU, value >> 16U & 0xFFU, value >> 24U}));
    return answer.data[0] == 0x60 ? 0 : number(answer);
  }
  std::uint32_t upload(unsigned index, unsigned sub = 0) {
    return number(ask(make(0x607, {0x40, index & 0xFFU, index >> 8U, sub, 0, 0, 0, 0})));
  }
  can::Frame ask(const can::Frame& request) {
    sent.frames.clear();
    hear(request);
    REQUIRE(sent.frames.size() == 1);
    CHECK(sent.frames[0].id == 0x587);
    return sent.frames[0];
  }
  static std::uint32_t number(const can::Frame& frame) {
    return frame.data[4] | frame.data[5] << 8U | frame.data[6] << 16U |
           static_cast<std::uint32_t>(frame.data[7]) << 24U;
  }
  bool hear(const can::Frame& frame) { return drive->accept(frame, joint, now_ns, sent); }
  /// Milliseconds with a SYNC and a heartbeat each.
  void live(int count) {
    for (int i = 0; i < count; ++i) {
      hear(make(0x77F, {0x05}));
      hear(make(0x080, {}));
      wait(1);
    }
  }
  void wait(int count) {
    for (int i = 0; i < count; ++i) {
      now_ns += kMillisecond;
      drive->watch(now_ns);
      drive->sample(joint, now_ns, sent);
    }
  }
  /// Status word, torque and position of the report that a command with SYNC brings.
  std::array<int, 3> command(unsigned controlword, int torque) {
    const auto raw = static_cast<unsigned>(torque);
    hear(make(0x207, {controlword & 0xFFU, controlword >> 8U, raw & 0xFFU, raw >> 8U & 0xFFU}));
    sent.frames.clear();
    hear(make(0x080, {}));
    REQUIRE(sent.frames.size() == 1);
    const can::Frame& report = sent.frames[0];
    CHECK(report.id == 0x187);
    CHECK(report.length == 8);
    return {report.data[0] | report.data[1] << 8,
            static_cast<std::int16_t>(report.data[2] | report.data[3] << 8),
            static_cast<std::int32_t>(number(report))};
  }
  int status(unsigned controlword) { return command(controlword, 0)[0] & 0x6F; }
  void enable() {
    status(0x06);
    status(0x07);
    status(0x0F);
    live(6);
    REQUIRE(drive->enabled());
  }
  const can::Frame* find(std::uint32_t id) const {
    for (const can::Frame& frame : sent.frames) {
      if (frame.id == id)
        return &frame;
    }
    return nullptr;
  }

  Collected sent;
  std::unique_ptr<FieldDrive> drive;
  JointReading joint;
  std::int64_t now_ns = kMillisecond;
};

void checkEmergency(Bench& bench, std::uint32_t code, unsigned error_register) {
  bench.sent.frames.clear();
  bench.wait(1);
  const can::Frame* emergency = bench.find(0x087);
  REQUIRE(emergency != nullptr);
  CHECK(emergency->length == 8);
  CHECK((emergency->data[0] | emergency->data[1] << 8U) == static_cast<int>(code));
  CHECK(emergency->data[2] == error_register);
}

}  // namespace

TEST_CASE("a drive tells of its start, then beats as it is told to, and moves between network states") {
  Bench bench(false);
  const can::Frame* boot = bench.find(0x707);
  REQUIRE(boot != nullptr);
  CHECK(boot->length == 1);
  CHECK(boot->data[0] == 0x00);
  bench.sent.frames.clear();
  bench.wait(30);
  CHECK(bench.sent.frames.empty());
  CHECK(bench.download(0x2B, 0x1017, 0, 10) == 0);
  for (const auto& [command, state] :
       {std::pair{0x80U, 0x7FU}, std::pair{0x01U, 0x05U}, std::pair{0x02U, 0x04U}}) {
    CHECK(bench.hear(make(0x000, {command, 0})));
    bench.sent.frames.clear();
    bench.wait(10);
    REQUIRE(bench.find(0x707) != nullptr);
    CHECK(bench.find(0x707)->data[0] == state);
  }
  bench.hear(make(0x000, {0x01, 8}));  // another's
  bench.sent.frames.clear();
  bench.wait(10);
  CHECK(bench.find(0x707)->data[0] == 0x04);
  bench.hear(make(0x000, {0x81, 7}));
  bench.sent.frames.clear();
  bench.wait(1);
  CHECK(bench.find(0x707)->data[0] == 0x00);
}

TEST_CASE("its dictionary: sizes, what cannot be written, what is not there") {
  Bench bench(false);
  CHECK(bench.upload(0x1000) == 0x00020192);
  CHECK((bench.upload(0x6502) >> 9U & 1U) == 1);
  CHECK(bench.upload(0x6076) == 500);
  CHECK(bench.ask(make(0x607, {0x40, 0x60, 0x60, 0, 0, 0, 0, 0})).data[0] == 0x4F);
  CHECK(bench.ask(make(0x607, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0})).data[0] == 0x4B);
  CHECK(bench.ask(make(0x607, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})).data[0] == 0x43);
  CHECK(bench.download(0x23, 0x1000, 0, 1) == 0x06010002);
  CHECK(bench.download(0x23, 0x2000, 0, 1) == 0x06020000);
  CHECK(bench.download(0x2F, 0x1018, 9, 1) == 0x06090011);
  CHECK(bench.download(0x23, 0x6060, 0, 10) == 0x06070010);
  CHECK(bench.download(0x2F, 0x6060, 0, 10) == 0);
  CHECK(bench.upload(0x6061) == 10);
}

TEST_CASE("PDOs are mapped anew only while they are off, with what can be in one") {
  Bench bench(false);
  CHECK(bench.download(0x2F, 0x1A00, 0, 0) == 0x08000022);
  CHECK(bench.download(0x2F, 0x1800, 2, 1) == 0x08000022);
  CHECK(bench.download(0x23, 0x1800, 1, 0x80000187) == 0);
  CHECK(bench.download(0x23, 0x1A00, 1, 0x60770010) == 0x08000022);
  CHECK(bench.download(0x2F, 0x1A00, 0, 0) == 0);
  CHECK(bench.download(0x23, 0x1A00, 1, 0x60770020) == 0x06040041);
  CHECK(bench.download(0x23, 0x1A00, 1, 0x60760020) == 0x06040041);
  CHECK(bench.download(0x23, 0x1A00, 1, 0x60640020) == 0);
  CHECK(bench.download(0x23, 0x1A00, 2, 0x60640020) == 0);
  CHECK(bench.download(0x23, 0x1A00, 3, 0x60410010) == 0);
  CHECK(bench.download(0x2F, 0x1A00, 0, 3) == 0x06040042);
  CHECK(bench.download(0x2F, 0x1A00, 0, 9) == 0x06040042);
  CHECK(bench.download(0x2F, 0x1A00, 0, 2) == 0);
  CHECK(bench.download(0x2F, 0x1800, 2, 1) == 0);
  CHECK(bench.download(0x23, 0x1800, 1, 0x187) == 0);
}

TEST_CASE("states: step by step to operation enabled, a brake's time included, and out from anywhere") {
  Bench bench;
  CHECK(bench.status(0x00) == 0x40);
  CHECK(bench.status(0x0F) == 0x40);  // no step is left out
  CHECK(bench.status(0x06) == 0x21);
  CHECK(bench.status(0x0F) == 0x21);
  CHECK(bench.status(0x07) == 0x23);
  CHECK(bench.status(0x0F) == 0x23);
  bench.live(4);
  CHECK(bench.status(0x0F) == 0x23);
  bench.live(1);
  CHECK(bench.status(0x0F) == 0x27);
  CHECK(bench.status(0x07) == 0x23);
  CHECK(bench.status(0x06) == 0x21);
  for (const auto& [word, state] : {std::pair{0x06U, 0x21}, std::pair{0x00U, 0x40}, std::pair{0x02U, 0x07}}) {
    bench.enable();
    CHECK(bench.status(word) == state);
    CHECK_FALSE(bench.drive->enabled());
    CHECK(bench.status(0x00) == 0x40);
  }
}

TEST_CASE("torque is whole thousandths of the rated torque, positions counts from its zero") {
  for (const int direction : {1, -1}) {
    Bench bench(true, direction);
    bench.joint.position_rad = 0.5 + 2.0 * std::numbers::pi / 8.0;
    CHECK(bench.command(0x06, 500)[2] == direction * 51200);
    CHECK(bench.drive->torque() == 0.0);
    bench.enable();
    const auto report = bench.command(0x0F, -321);
    CHECK(bench.drive->torque() == doctest::Approx(-16.05 * direction));
    CHECK(report[1] == -321);
    CHECK(bench.command(0x0F, 30000)[1] == 1200);  // 60 N·m at most
    CHECK(std::abs(bench.drive->torque()) == doctest::Approx(60.0));
    bench.command(0x06, 500);
    CHECK(bench.drive->torque() == 0.0);
  }
  Bench other;  // in a mode of positions, target torque is nobody's
  other.download(0x2F, 0x6060, 0, 8);
  other.enable();
  other.command(0x0F, 500);
  CHECK(other.drive->torque() == 0.0);
}

TEST_CASE(
    "without the loop's heartbeat, or without SYNC, it falls into a fault and says why; an edge clears it") {
  Bench bench;
  bench.enable();
  bench.command(0x0F, 100);
  for (int i = 0; i < 18; ++i) {
    bench.hear(make(0x080, {}));
    bench.wait(1);
  }
  CHECK(bench.drive->enabled());
  bench.hear(make(0x080, {}));
  bench.wait(1);
  CHECK_FALSE(bench.drive->enabled());
  CHECK(bench.drive->torque() == 0.0);
  CHECK(bench.drive->watchdogTrips() == 1);
  CHECK(bench.upload(0x603F) == 0x8130);
  CHECK((bench.status(0x00) & 0x4F) == 0x08);
  CHECK((bench.status(0x0F) & 0x4F) == 0x08);
  CHECK(bench.status(0x80) == 0x40);
  CHECK(bench.status(0x80) == 0x40);
  bench.status(0x00);
  bench.enable();
  for (int i = 0; i < 5; ++i) {
    bench.hear(make(0x77F, {0x05}));
    bench.wait(1);
  }
  CHECK_FALSE(bench.drive->enabled());
  CHECK(bench.upload(0x603F) == 0x8700);
}

TEST_CASE("an emergency goes out with code and register, and another when the error has gone") {
  Bench bench;
  bench.enable();
  bench.drive->defect({.faulty = true}, bench.now_ns);
  checkEmergency(bench, 0x4310, 0x01);
  CHECK_FALSE(bench.drive->enabled());
  CHECK((bench.status(0x80) & 0x4F) == 0x08);  // it is still there
  bench.drive->defect({}, bench.now_ns);
  bench.status(0x00);
  CHECK(bench.status(0x80) == 0x40);
  checkEmergency(bench, 0x0000, 0x00);
}

TEST_CASE("defects: silence, a reboot that forgets, leaving, ignoring, deafness to SYNC") {
  Bench bench;
  bench.enable();
  bench.drive->defect({.silent = true}, bench.now_ns);
  bench.sent.frames.clear();
  bench.live(20);
  CHECK(bench.sent.frames.empty());
  CHECK(bench.drive->enabled());
  bench.drive->defect({.leaves = true}, bench.now_ns);
  CHECK(bench.status(0x0F) == 0x40);
  bench.drive->defect({.ignores_enter = true}, bench.now_ns);
  bench.status(0x06);
  bench.status(0x07);
  bench.status(0x0F);
  bench.live(20);
  CHECK(bench.status(0x0F) == 0x23);
  bench.drive->defect({.loses_sync = true}, bench.now_ns);
  bench.sent.frames.clear();
  CHECK_FALSE(bench.hear(make(0x080, {})));
  CHECK(bench.sent.frames.empty());
  bench.drive->defect({.off = true}, bench.now_ns);
  bench.drive->defect({}, bench.now_ns);
  bench.sent.frames.clear();
  bench.wait(1);
  REQUIRE(bench.find(0x707) != nullptr);
  CHECK(bench.find(0x707)->data[0] == 0x00);
  CHECK(bench.upload(0x6060) == 0);
  CHECK(bench.upload(0x1400, 1) == 0x207);
  CHECK_FALSE(bench.hear(make(0x080, {})));  // not operational
}
