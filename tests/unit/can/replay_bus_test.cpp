#include "drivers/can/replay_bus.hpp"

#include <array>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/candump_log.hpp"
#include "tests/unit/can/temporary_file.hpp"

using namespace patella::can;

namespace {

// Four ticks with command 080: two frames, one, none, and what came after the last command.
const std::string kOwnLog =
    "(0000000100.000100) can0 110#01\n"
    "(0000000100.000200) can0 111#02\n"
    "(0000000100.000300) can0 080#AA00\n"
    "(0000000100.900000) can0 110#03\n"
    "(0000000100.900001) can0 080#AA01\n"
    "(0000000100.900002) can0 080#AA02\n"
    "(0000000100.900003) can0 120#04\n";

ReplayOptions ownOptions() {
  ReplayOptions options;
  options.command_id = 0x80;
  return options;
}

Frame command(std::uint8_t low) {
  Frame frame;
  frame.id = 0x80;
  frame.length = 2;
  frame.data = {0xAA, low};
  return frame;
}

}  // namespace

TEST_CASE("each receive gives one recorded tick in file order, however time runs") {
  const test::TemporaryFile log(kOwnLog);
  ReplayBus bus(log.path(), ownOptions());
  CHECK(bus.hasCommands());
  CHECK(bus.recordedCommands() == 3);
  std::array<Frame, 8> frames;

  REQUIRE(bus.receive(frames, 1000) == 2);
  CHECK(frames[0].data[0] == 1);
  CHECK(frames[1].data[0] == 2);
  CHECK(frames[1].monotonic_ns == 1000);
  CHECK(frames[1].wall_ns == 100'000'200'000);
  CHECK(bus.receive(frames, 1000) == 0);
  REQUIRE(bus.receive(frames, 1001) == 1);
  CHECK(frames[0].data[0] == 3);
  CHECK(bus.receive(frames, 999'999'999'999) == 0);
  CHECK_FALSE(bus.exhausted());
  REQUIRE(bus.receive(frames, 1'000'000'000'000) == 1);
  CHECK(frames[0].id == 0x120);
  CHECK(bus.exhausted());
  CHECK(bus.receive(frames, 1'000'000'000'001) == 0);
}

TEST_CASE("the loop's farewell at the end of a log closes no tick") {
  const std::string farewell = "(0000000101.000000) can0 080#0000\n(0000000101.001000) can0 080#0001\n";
  const std::string own = kOwnLog.substr(0, kOwnLog.rfind("(0000000100.900002)"));
  ReplayOptions options = ownOptions();
  options.farewell_commands = 2;

  const test::TemporaryFile complete(own + farewell);
  CHECK(ReplayBus(complete.path(), options).recordedCommands() == 2);
  // The log of a killed loop has no farewell, and its last ticks are ticks.
  const test::TemporaryFile killed(own);
  CHECK(ReplayBus(killed.path(), options).recordedCommands() == 2);
  const test::TemporaryFile without_option(own + farewell);
  CHECK(ReplayBus(without_option.path(), ownOptions()).recordedCommands() == 4);
}

TEST_CASE("a tick with more frames than there is room for is given in pieces and not mixed with the next") {
  const test::TemporaryFile log(kOwnLog);
  ReplayBus bus(log.path(), ownOptions());
  std::array<Frame, 1> one;
  REQUIRE(bus.receive(one, 1000) == 1);
  CHECK(one[0].data[0] == 1);
  SUBCASE("within the tick") {
    REQUIRE(bus.receive(one, 1000) == 1);
    CHECK(one[0].data[0] == 2);
    CHECK(bus.receive(one, 1000) == 0);
  }
  SUBCASE("at the next") {
    REQUIRE(bus.receive(one, 2000) == 1);
    CHECK(one[0].data[0] == 2);
    CHECK(bus.receive(one, 2000) == 0);
  }
  REQUIRE(bus.receive(one, 3000) == 1);
  CHECK(one[0].data[0] == 3);
}

TEST_CASE("what is sent is compared with what was recorded") {
  const test::TemporaryFile log(kOwnLog);
  ReplayBus bus(log.path(), ownOptions());
  Frame first = command(0);
  CHECK(bus.send(first, 7) == SendResult::kSent);
  CHECK(first.monotonic_ns == 7);
  CHECK(first.wall_ns == 100'000'300'000);
  CHECK(bus.commandMismatches() == 0);
  Frame second = command(9);
  bus.send(second, 8);
  CHECK(bus.commandMismatches() == 1);
  Frame third = command(2);
  bus.send(third, 9);
  // Beyond the recording there is nothing to compare with.
  bus.send(third, 10);
  CHECK(bus.commandMismatches() == 1);
  CHECK(bus.statistics().frames_sent == 4);
}

TEST_CASE("a log whose command has another identifier is foreign, and its clock is mapped onto the loop's") {
  const test::TemporaryFile log(kOwnLog);
  ReplayOptions options;
  options.command_id = 0x80;
  options.command_extended = true;
  ReplayBus bus(log.path(), options);
  CHECK_FALSE(bus.hasCommands());
  std::array<Frame, 8> frames;
  constexpr std::int64_t kStart = 50'000'000;
  CHECK(bus.receive(frames, kStart) == 1);
  CHECK(frames[0].monotonic_ns == kStart);
  CHECK(bus.receive(frames, kStart + 99'999) == 0);
  CHECK(bus.receive(frames, kStart + 100'000) == 1);
  CHECK(frames[0].monotonic_ns == kStart + 100'000);
  CHECK(bus.receive(frames, kStart + 1'000'000'000) == 5);
  CHECK(bus.exhausted());
  Frame frame = command(0);
  CHECK(bus.send(frame, kStart) == SendResult::kSent);
  CHECK(bus.commandMismatches() == 0);
}

TEST_CASE("recorded error reports put the bus down and up again") {
  const test::TemporaryFile log(
      "(0000000001.000000) can0 20000040#0000000000000000\n"
      "(0000000001.000001) can0 080#00\n"
      "(0000000001.000002) can0 20000004#0010000000000000\n"
      "(0000000001.000003) can0 080#00\n"
      "(0000000001.000004) can0 20000100#0000000000000000\n"
      "(0000000001.000005) can0 080#00\n");
  ReplayBus bus(log.path(), ownOptions());
  std::array<Frame, 4> frames;
  CHECK_FALSE(bus.down());
  bus.receive(frames, 1);
  CHECK(bus.down());
  bus.receive(frames, 2);
  CHECK(bus.down());
  bus.receive(frames, 3);
  CHECK_FALSE(bus.down());
  CHECK(bus.statistics().error_frames == 3);
  CHECK(bus.statistics().bus_off == 1);
  CHECK(bus.statistics().error_passive == 1);
}

TEST_CASE("the whole log is checked before the first frame is given") {
  const test::TemporaryFile broken(kOwnLog + "(0000000101.000000) can0 11\n");
  CHECK_THROWS_WITH_AS(
      ReplayBus(broken.path(), ownOptions()),
      (broken.path().string() + ":8: found '11', expected a frame such as 202#9019F500").c_str(), LogError);
  const test::TemporaryFile empty("");
  CHECK_THROWS_WITH_AS(ReplayBus(empty.path()), (empty.path().string() + ": holds no frame").c_str(),
                       LogError);
}

TEST_CASE("a log that is played by its stamps is refused where they jump, and a loop's own is not") {
  const std::string before = "(0000000001.000000) can0 110#01\n";
  const std::string after = "(1604665770.960915) can0 110#02\n(1604665770.961915) can0 110#03\n";
  const auto refusal = [](const std::string& text, const ReplayOptions& options = {}) -> std::string {
    const test::TemporaryFile log(text);
    try {
      ReplayBus(log.path(), options);
    } catch (const LogError& error) {
      return std::string(error.what()).substr(log.path().string().size());
    }
    return "accepted";
  };
  CHECK(
      refusal(before + after) ==
      ":2: the stamps jump from 1.000000 to 1604665770.960915, expected at most 60 s forward and 1 s back in "
      "a log that is played by its stamps; cut it there, or mend them");
  CHECK(refusal(after + before).starts_with(":3: the stamps jump from 1604665770.961915 to 1.000000"));
  const auto at = [](const char* stamp) { return "(" + std::string(stamp) + ") can0 110#01\n"; };
  CHECK(refusal(at("0000000100.000000") + at("0000000160.000000")) == "accepted");
  CHECK(refusal(at("0000000100.000000") + at("0000000160.000001")) != "accepted");
  CHECK(refusal(at("0000000100.000000") + at("0000000099.000000")) == "accepted");
  CHECK(refusal(at("0000000100.000000") + at("0000000098.999999")) != "accepted");
  // Small steps back add up: each is held against the newest stamp.
  CHECK(refusal(at("0000000100.000000") + at("0000000099.400000") + at("0000000098.800000")) != "accepted");
  CHECK(refusal(before + after + "(1604665770.961916) can0 080#AA00\n", ownOptions()) == "accepted");
}

TEST_CASE("frames that were played are counted, down to the last") {
  const test::TemporaryFile log(kOwnLog);
  ReplayBus bus(log.path(), ownOptions());
  std::array<Frame, 8> frames;
  CHECK(bus.frames() == 4);
  CHECK(bus.playedFrames() == 0);
  bus.receive(frames, 1000);
  CHECK(bus.playedFrames() == 2);
  for (std::int64_t now = 2000; !bus.exhausted(); now += 1000)
    bus.receive(frames, now);
  CHECK(bus.playedFrames() == bus.frames());
}
