// Several buses behind one object: frames find their way by number, and no bus takes anything from another.
#include "drivers/can/bus_group.hpp"

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include <doctest/doctest.h>

#include "drivers/can/bus_load.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/error_monitor.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "tests/unit/can/rig_map.hpp"

using namespace patella;
using namespace patella::can;

namespace {

/// Gives as many frames as it is asked for, up to so many; each has a running number.
class HandBus final : public Bus {
 public:
  explicit HandBus(std::size_t frames = 0) : waiting(frames) {}
  std::size_t receive(std::span<Frame> frames, std::int64_t) noexcept PATELLA_NONBLOCKING override {
    std::size_t count = 0;
    for (; count < frames.size() && waiting > 0; ++count, --waiting) {
      frames[count] = Frame{};
      frames[count].id = next++;
    }
    return count;
  }
  SendResult send(Frame& frame, std::int64_t) noexcept PATELLA_NONBLOCKING override {
    if (is_down) {
      return SendResult::kDown;
    }
    sent.push_back(frame.id);
    return SendResult::kSent;
  }
  void discardPending() noexcept override { waiting = 0; }
  bool down() const noexcept override { return is_down; }
  BusStatistics statistics() const noexcept override {
    BusStatistics counts;
    counts.frames_sent = sent.size();
    return counts;
  }

  std::size_t waiting;
  std::uint32_t next = 1;
  bool is_down = false;
  std::vector<std::uint32_t> sent;
};

struct Pair {
  Pair(std::size_t first_waiting, std::size_t second_waiting)
      : first(new HandBus(first_waiting)), second(new HandBus(second_waiting)), group(take()) {}
  std::vector<std::unique_ptr<Bus>> take() const {
    std::vector<std::unique_ptr<Bus>> buses;
    buses.emplace_back(first);
    buses.emplace_back(second);
    return buses;
  }
  HandBus* first;
  HandBus* second;
  BusGroup group;
};

Frame frameOn(std::uint8_t bus, std::uint32_t id) {
  Frame frame;
  frame.bus = bus;
  frame.id = id;
  return frame;
}

/// The rig's description with the second encoder on another bus.
Database twoBuses() {
  Database database = test::rigDatabase();
  for (Message& message : database.messages) {
    message.bus = message.name == "Encoder2" || message.name == "Emg" ? 1 : 0;
  }
  return database;
}

}  // namespace

TEST_CASE("a group: frames carry the number of their bus in both directions") {
  Pair pair(2, 1);
  std::array<Frame, 16> frames;
  REQUIRE(pair.group.receive(frames, 0) == 3);
  CHECK(frames[0].bus == 0);
  CHECK(frames[1].bus == 0);
  CHECK(frames[2].bus == 1);
  for (const unsigned bus : {1U, 0U, 1U}) {
    Frame frame = frameOn(static_cast<std::uint8_t>(bus), 0x10U + bus);
    CHECK(pair.group.send(frame, 0) == SendResult::kSent);
  }
  CHECK(pair.first->sent == std::vector<std::uint32_t>{0x10});
  CHECK(pair.second->sent == std::vector<std::uint32_t>{0x11, 0x11});
  CHECK(pair.group.statistics().frames_sent == 3);
  CHECK(pair.group.statisticsOf(1).frames_sent == 2);
  Frame nowhere = frameOn(2, 1);
  CHECK(pair.group.send(nowhere, 0) == SendResult::kDown);
  CHECK(pair.group.statisticsOf(2).frames_sent == 0);
}

TEST_CASE(
    "a group: a flooded bus leaves the other its part, and one that is down takes only its own frames") {
  Pair pair(1000, 3);
  std::array<Frame, 16> frames;
  REQUIRE(pair.group.receive(frames, 0) == 11);
  CHECK(frames[7].bus == 0);
  CHECK(frames[8].bus == 1);
  CHECK(pair.second->waiting == 0);
  pair.second->is_down = true;
  CHECK(pair.group.down());
  CHECK(pair.group.downBuses() == busBit(1));
  Frame lost = frameOn(1, 1);
  Frame kept = frameOn(0, 1);
  CHECK(pair.group.send(lost, 0) == SendResult::kDown);
  CHECK(pair.group.send(kept, 0) == SendResult::kSent);
  pair.group.discardPending();
  CHECK(pair.group.receive(frames, 0) == 0);
}

TEST_CASE("a group has at least one bus and at most kMaxBuses") {
  CHECK_THROWS_AS(BusGroup({}), std::invalid_argument);
  std::vector<std::unique_ptr<Bus>> many;
  for (std::size_t i = 0; i <= kMaxBuses; ++i) {
    many.push_back(std::make_unique<HandBus>());
  }
  CHECK_THROWS_AS(BusGroup(std::move(many)), std::invalid_argument);
}

TEST_CASE("one of several buses: others are passed over, all of its own come") {
  Pair pair(40, 20);
  OneOfBuses second(pair.group, 1);
  std::array<Frame, 8> frames;
  std::size_t heard = 0;
  std::size_t count = frames.size();
  while (count == frames.size()) {
    count = second.receive(frames, 0);
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(frames[i].bus == 1);
      CHECK(frames[i].id == ++heard);
    }
  }
  CHECK(heard == 20);
  Frame frame = frameOn(0, 5);
  CHECK(second.send(frame, 0) == SendResult::kSent);
  CHECK(pair.second->sent == std::vector<std::uint32_t>{5});
  pair.first->is_down = true;
  CHECK_FALSE(second.down());
  pair.second->is_down = true;
  CHECK(second.down());
}

TEST_CASE("a message is heard on its own bus alone, and what is missing names that bus") {
  const Database database = twoBuses();
  MeasurementDecoder decoder(database, test::rigMap(), 2);
  const auto tell = [&](const char* message, std::uint8_t bus, std::uint8_t counter) {
    MessageEncoder encoder(database.message(message), test::protectionOf(message));
    Frame frame = encoder.blank();
    CHECK(frame.bus == database.message(message).bus);
    for (int i = 0; i <= counter; ++i) {
      encoder.seal(frame);
    }
    frame.bus = bus;
    frame.monotonic_ns = counter * 1'000'000LL;
    decoder.accept(frame);
  };
  tell("Encoder1", 0, 0);
  tell("Encoder2", 0, 0);
  CHECK(decoder.unknownFrames() == 1);
  tell("Encoder2", 1, 0);
  CHECK(decoder.finish(0).fault_buses == 0);
  for (std::uint8_t tick = 1; tick < 10; ++tick) {
    tell("Encoder1", 0, tick);
  }
  const Reading reading = decoder.finish(9'000'000);
  CHECK(reading.faults.has(safety::Fault::kEncoderStale));
  CHECK(reading.fault_buses == busBit(1));
}

TEST_CASE("a command is that of its own bus, and the same identifier on another is none") {
  Database database = test::rigDatabase();
  for (Message& message : database.messages) {
    message.bus = 1;
  }
  const CommandMap map{.message = "TorqueCommand",
                       .bindings = {{.input = "torque_Nm.1", .message = "", .signal = "Torque1"},
                                    {.input = "torque_Nm.2", .message = "", .signal = "Torque2"}},
                       .protection = test::protectionOf("TorqueCommand")};
  CommandEncoder encoder(database, map, 2);
  Command command{JointVector::Zero(2), true, 2};
  Frame frame = encoder.encode(command);
  CHECK(frame.bus == 1);
  CHECK(encoder.commands(frame));
  frame.bus = 0;
  CHECK_FALSE(encoder.commands(frame));
}

TEST_CASE("each bus has its own load, and their sum is that of one bus") {
  const Database one = test::rigDatabase();
  const Database two = twoBuses();
  const BusMap map = test::rigMap();
  const BusLoad whole = busLoad(one, map, {}, 1000.0);
  const BusLoad first = busLoad(two, map, {}, 1000.0, 0);
  const BusLoad second = busLoad(two, map, {}, 1000.0, 1);
  CHECK(first.frames_per_s + second.frames_per_s == doctest::Approx(whole.frames_per_s));
  CHECK(first.bits_per_s + second.bits_per_s == doctest::Approx(whole.bits_per_s));
  CHECK(second.frames_per_s == doctest::Approx(2000.0));  // an encoder and EMG, each 1 kHz
}

TEST_CASE("error reports are followed bus by bus") {
  ErrorMonitor monitor;
  BusStatistics counts;
  Frame off = frameOn(1, kErrorBusOff);
  off.error = true;
  monitor.beginReceive();
  monitor.observe(off, counts);
  CHECK(monitor.wasOff() == busBit(1));
  monitor.beginReceive();
  monitor.observe(frameOn(0, 5), counts);  // another bus's frame proves nothing of this one
  CHECK(monitor.wasOff() == busBit(1));
  monitor.observe(frameOn(1, 5), counts);
  CHECK(monitor.wasOff() == 0);
}
