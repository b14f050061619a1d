#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/replay_bus.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella::can;

namespace {
const std::filesystem::path kVehicle = patella::checkout::recordings() / "can" / "vehicle_2p5s.log";
}

TEST_CASE("a vehicle's log is read in full and written back byte for byte") {
  CandumpReader reader(kVehicle);
  LogEntry entry;
  std::string written;
  std::map<std::uint32_t, int> frames;
  std::int64_t first_ns = 0;
  while (reader.next(entry)) {
    if (written.empty())
      first_ns = entry.frame.wall_ns;
    ++frames[entry.frame.id];
    std::array<char, kMaxLogLine> line;
    written.append(line.data(), formatLogLine(line, entry));
  }
  CHECK(reader.line() == 5396);
  CHECK(frames.size() == 11);
  CHECK(frames[0x202] == 1275);
  CHECK(frames[0x0FF] == 17);
  CHECK(first_ns == 1604665770'960915'000);
  CHECK(entry.frame.wall_ns == 1604665773'510499'000);
  CHECK(entry.frame.length == 5);

  std::ifstream stream(kVehicle, std::ios::binary);
  const std::string original{std::istreambuf_iterator<char>(stream), {}};
  // The log's last line has no line feed.
  CHECK(written == original + "\n");
}

TEST_CASE("a foreign log is given by its stamps, each frame within the tick in which it came") {
  ReplayBus bus(kVehicle);
  std::array<Frame, 256> frames;
  std::size_t total = 0;
  std::int64_t now_ns = 5'000'000'000;
  std::int64_t last_ns = 0;
  int ticks = 0;
  for (; !bus.exhausted(); now_ns += 1'000'000, ++ticks) {
    const std::size_t count = bus.receive(frames, now_ns);
    total += count;
    for (std::size_t i = 0; i < count; ++i) {
      REQUIRE(frames[i].monotonic_ns <= now_ns);
      REQUIRE(frames[i].monotonic_ns > now_ns - (ticks == 0 ? 1 : 1'000'000));
      REQUIRE(frames[i].wall_ns >= last_ns);
      last_ns = frames[i].wall_ns;
    }
    REQUIRE(ticks < 3000);
  }
  CHECK(total == 5396);
  CHECK(ticks == 2551);  // 2.549584 s from the first frame to the last
  CHECK(bus.statistics().frames_received == 5396);
}
