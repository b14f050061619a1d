// Messages through shared memory, with readers that keep up and readers that do not.
#include "firmware_app/live/live_ring.hpp"

#include <atomic>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware_app/live/live_run.hpp"

using namespace patella::live;

namespace {

std::string ownName(const char* what) {
  return "/patella-test-" + std::to_string(getpid()) + "-" + what;
}

// Its number and then as many bytes of it as the number says.
std::string numbered(std::uint64_t number) {
  std::string data(sizeof(number) + number % 700, static_cast<char>(number % 251));
  std::memcpy(data.data(), &number, sizeof(number));
  return data;
}

std::uint64_t numberOf(const LiveMessage& message) {
  std::uint64_t number = 0;
  REQUIRE(message.data.size() >= sizeof(number));
  std::memcpy(&number, message.data.data(), sizeof(number));
  return number;
}

}  // namespace

TEST_CASE("a reader that keeps up gets every message as it was, beyond many turns of the ring") {
  const std::string name = ownName("turns");
  RingWriter writer(name, "what it is");
  RingReader reader(name);
  CHECK(reader.description() == "what it is");
  LiveMessage message;
  CHECK_FALSE(reader.next(message));
  for (std::uint64_t i = 0; i < 40'000; ++i) {
    writer.write(static_cast<std::uint16_t>(i % 7), i * 1000, numbered(i));
    REQUIRE(reader.next(message));
    REQUIRE(message.channel == i % 7);
    REQUIRE(message.wall_ns == i * 1000);
    REQUIRE(message.data == numbered(i));
  }
  CHECK_FALSE(reader.next(message));
  CHECK(reader.overruns() == 0);
}

TEST_CASE("rings of runs that died go, those of living runs stay") {
  const std::string dead = ownName("dead");
  const std::string alive = ownName("alive");
  const pid_t run = fork();
  if (run == 0) {
    const RingWriter writer(dead, "");
    _exit(0);  // as a run that is killed: nothing takes the name away
  }
  waitpid(run, nullptr, 0);
  const RingWriter writer(alive, "");
  const auto there = [](const std::string& name) { return std::filesystem::exists("/dev/shm" + name); };
  CHECK(there(dead));
  removeLeftRings();
  CHECK_FALSE(there(dead));
  CHECK(there(alive));
  CHECK_NOTHROW(RingReader{alive});
}

TEST_CASE("a ring whose lock is held stays, whatever the number of its writer says") {
  const std::string name = ownName("other-container");
  const pid_t run = fork();
  if (run == 0) {
    const RingWriter writer(name, "");
    _exit(0);
  }
  waitpid(run, nullptr, 0);
  const int file = shm_open(name.c_str(), O_RDONLY, 0);
  REQUIRE(file >= 0);
  CHECK(flock(file, LOCK_EX) == 0);
  removeLeftRings();
  CHECK_NOTHROW(RingReader{name});
  close(file);
  removeLeftRings();
  CHECK_THROWS_AS(RingReader{name}, std::runtime_error);
}

TEST_CASE("a reader that is too late goes on with what comes next, and never sees a torn message") {
  const std::string name = ownName("late");
  RingWriter writer(name, "");
  RingReader late(name);
  std::atomic<bool> stop{false};
  std::thread thread([&] {
    for (std::uint64_t i = 0; i < 300'000; ++i) {
      writer.write(1, i, numbered(i));
    }
    stop = true;
  });
  LiveMessage message;
  std::uint64_t newest = 0;
  std::uint64_t read = 0;
  bool sound = true;
  while (!stop) {
    if (late.next(message)) {
      const std::uint64_t number = numberOf(message);
      sound = sound && message.wall_ns == number && message.data == numbered(number) &&
              (read == 0 || number > newest);
      newest = number;
      ++read;
    }
  }
  thread.join();
  CHECK(sound);
  // Now it is too late for certain.
  while (late.next(message)) {
  }
  const std::uint64_t before = late.overruns();
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    writer.write(1, i, numbered(i));
  }
  CHECK_FALSE(late.next(message));
  CHECK(late.overruns() == before + 1);
  writer.write(2, 3, "x");
  REQUIRE(late.next(message));
  CHECK(message.data == "x");
}

TEST_CASE("a reader sees that the run has ended, and a ring that is not there is told of") {
  const std::string name = ownName("end");
  auto writer = std::make_unique<RingWriter>(name, "");
  const RingReader reader(name);
  CHECK_FALSE(reader.ended());
  writer.reset();
  CHECK(reader.ended());
  CHECK_THROWS_WITH_AS(RingReader{name}, doctest::Contains("No such file"), std::runtime_error);
  CHECK_THROWS_AS(RingWriter(name, std::string(kDescriptionBytes + 1, 'x')), std::runtime_error);
}

TEST_CASE("a run tells its readers the channels that it writes") {
  const std::filesystem::path folder = "/tmp/patella-live-" + std::to_string(getpid());
  LiveRun run(folder, {"t_s", "q1_rad", "state"});
  RingReader reader(ringName(folder));
  const auto channels = channelsOf(reader.description());
  REQUIRE(channels.size() == patella::formats::kRunChannels);
  CHECK(channels[0].columns == "t_s,q1_rad,state");
  CHECK_THROWS_AS(channelsOf("{}"), std::runtime_error);
  run.tick(std::vector{0.5, 1.0, 2.0}, {.wall_ns = 7, .loop_ns = 8});
  LiveMessage message;
  REQUIRE(reader.next(message));
  CHECK(message.wall_ns == 7);
  patella::formats::CdrReader tick(message.data);
  CHECK(tick.number<double>() == 0.5);
}
