// Needs a CAN interface that echoes, such as vcan, named by PATELLA_CAN_INTERFACE; skipped without. Nothing
// else may use the interface meanwhile.
#define DOCTEST_CONFIG_IMPLEMENT
#include "drivers/can/socketcan_bus.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

using namespace patella::can;

namespace {

constexpr int kSkipped = 77;
const char* const kInterface = std::getenv("PATELLA_CAN_INTERFACE");

Frame makeFrame(std::uint32_t id, std::uint8_t length, std::uint8_t first = 0) {
  Frame frame;
  frame.id = id;
  frame.length = length;
  for (std::uint8_t i = 0; i < length; ++i)
    frame.data[i] = static_cast<std::uint8_t>(first + i);
  return frame;
}

/// Everything that arrives within a second, or as soon as `expected` frames are there.
std::vector<Frame> collect(SocketCanBus& bus, std::size_t expected) {
  std::vector<Frame> all;
  std::array<Frame, 128> frames;
  for (int i = 0; i < 1000 && all.size() < expected; ++i) {
    const std::size_t count = bus.receive(frames, 1000 + i);
    all.insert(all.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return all;
}

bool sameContent(const Frame& a, const Frame& b) {
  return a.id == b.id && a.extended == b.extended && a.remote == b.remote && a.fd == b.fd &&
         a.bit_rate_switch == b.bit_rate_switch && a.length == b.length && a.data == b.data;
}

/// Puts an error report on the interface as a controller would.
void injectError(std::uint32_t classes) {
  const int fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(kInterface));
  can_frame frame{};
  frame.can_id = CAN_ERR_FLAG | classes;
  frame.len = CAN_ERR_DLC;
  const bool sent = fd >= 0 && bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0 &&
                    write(fd, &frame, sizeof(frame)) == static_cast<ssize_t>(sizeof(frame));
  close(fd);
  REQUIRE(sent);
}

bool setUp(bool up) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq query{};
  std::snprintf(query.ifr_name, IFNAMSIZ, "%s", kInterface);
  bool done = fd >= 0 && ioctl(fd, SIOCGIFFLAGS, &query) == 0;
  if (done) {
    const int flags = up ? query.ifr_flags | IFF_UP : query.ifr_flags & ~IFF_UP;
    query.ifr_flags = static_cast<short>(flags);
    done = ioctl(fd, SIOCSIFFLAGS, &query) == 0;
  }
  close(fd);
  return done;
}

}  // namespace

TEST_CASE("frames pass both ways with all that they hold") {
  SocketCanBus here(kInterface);
  SocketCanBus there(kInterface);
  std::vector<Frame> sent = {makeFrame(0x123, 8, 1), makeFrame(0x7FF, 0), makeFrame(0x1ABCDEF0, 3, 9)};
  sent[2].extended = true;
  sent.push_back(makeFrame(0x321, 0));
  sent[3].remote = true;
  for (Frame& frame : sent) {
    REQUIRE(here.send(frame, 42) == SendResult::kSent);
    CHECK(frame.monotonic_ns == 42);
    CHECK(frame.wall_ns > 0);
  }
  const std::vector<Frame> received = collect(there, sent.size());
  REQUIRE(received.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    CHECK(sameContent(received[i], sent[i]));
    CHECK_FALSE(received[i].own);
  }
  Frame back = makeFrame(0x200, 2);
  REQUIRE(there.send(back, 43) == SendResult::kSent);
  const std::vector<Frame> at_first = collect(here, sent.size() + 1);
  REQUIRE(at_first.size() == sent.size() + 1);
  CHECK(at_first.front().own);
  CHECK_FALSE(at_first.back().own);
  CHECK(sameContent(at_first.back(), back));
  CHECK(here.statistics().frames_sent == sent.size());
  CHECK(here.statistics().frames_received == 1);
  CHECK(there.statistics().frames_received == sent.size());
}

TEST_CASE("CAN FD frames keep their length and bit-rate switch") {
  SocketCanBus here(kInterface);
  SocketCanBus there(kInterface);
  if (!here.flexibleDataRate()) {
    SocketCanOptions options;
    options.require_fd = true;
    CHECK_THROWS_WITH_AS(SocketCanBus(kInterface, options), doctest::Contains("expected CAN FD"),
                         std::runtime_error);
    return;
  }
  Frame frame = makeFrame(0x100, 64, 5);
  frame.fd = true;
  frame.bit_rate_switch = true;
  REQUIRE(here.send(frame, 0) == SendResult::kSent);
  const std::vector<Frame> received = collect(there, 1);
  REQUIRE(received.size() == 1);
  CHECK(sameContent(received[0], frame));
}

TEST_CASE("a frame that waited in the socket is as old as it waited") {
  SocketCanBus here(kInterface);
  SocketCanBus there(kInterface);
  std::array<Frame, 16> frames;
  here.receive(frames, 0);
  Frame frame = makeFrame(0x110, 8, 1);
  REQUIRE(there.send(frame, 0) == SendResult::kSent);
  constexpr std::chrono::milliseconds kWaited{20};
  std::this_thread::sleep_for(kWaited);
  REQUIRE(here.receive(frames, 7) == 1);
  CHECK(frames[0].monotonic_ns == 7);
  CHECK(frames[0].age_ns >= std::chrono::nanoseconds(kWaited).count() / 2);
  CHECK(frames[0].age_ns < 50 * std::chrono::nanoseconds(kWaited).count());
}

TEST_CASE("echoes are flagged, and their stamps and those of others' frames are of one clock") {
  SocketCanBus here(kInterface);
  SocketCanBus there(kInterface);
  std::array<Frame, 16> frames;
  std::int64_t last_ns = 0;
  for (int i = 0; i < 50; ++i) {
    Frame sensor = makeFrame(0x110, 8, static_cast<std::uint8_t>(i));
    Frame torque = makeFrame(0x080, 8, static_cast<std::uint8_t>(i));
    REQUIRE(there.send(sensor, i) == SendResult::kSent);
    REQUIRE(here.send(torque, i) == SendResult::kSent);
    const std::vector<Frame> both = collect(here, 2);
    REQUIRE(both.size() == 2);
    CHECK_FALSE(both[0].own);
    CHECK(both[1].own);
    CHECK(both[0].wall_ns > last_ns);
    CHECK(both[1].wall_ns > both[0].wall_ns);
    last_ns = both[1].wall_ns;
    there.receive(frames, i);
  }
}

TEST_CASE("an error report of bus-off stops sending until the bus is seen alive") {
  SocketCanBus here(kInterface);
  SocketCanBus there(kInterface);
  CHECK_FALSE(here.down());
  injectError(0x40);
  const std::vector<Frame> report = collect(here, 1);
  REQUIRE(report.size() == 1);
  CHECK(report[0].error);
  CHECK(report[0].id == 0x40);
  CHECK(here.down());
  CHECK(here.statistics().bus_off == 1);
  Frame torque = makeFrame(0x080, 8);
  CHECK(here.send(torque, 0) == SendResult::kDown);

  SUBCASE("by the controller's restart") {
    injectError(0x100);
  }
  SUBCASE("by a frame from another node") {
    Frame frame = makeFrame(0x110, 8);
    REQUIRE(there.send(frame, 0) == SendResult::kSent);
  }
  collect(here, 1);
  CHECK_FALSE(here.down());
  CHECK(here.send(torque, 0) == SendResult::kSent);
}

TEST_CASE("lost arbitration is not reported") {
  SocketCanBus here(kInterface);
  injectError(0x02);
  injectError(0x40);
  const std::vector<Frame> reports = collect(here, 1);
  REQUIRE(reports.size() == 1);
  CHECK(reports[0].id == 0x40);
}

TEST_CASE("frames that the socket had no room for are counted") {
  SocketCanOptions options;
  options.receive_buffer_bytes = 4096;
  SocketCanBus here(kInterface, options);
  SocketCanBus there(kInterface);
  constexpr std::uint64_t kSent = 400;
  std::array<Frame, 64> frames;
  for (std::uint64_t i = 0; i < kSent; ++i) {
    Frame frame = makeFrame(0x110, 8);
    REQUIRE(there.send(frame, 0) == SendResult::kSent);
    there.receive(frames, 0);
  }
  const std::size_t kept = collect(here, kSent).size();
  CHECK(kept > 0);
  CHECK(kept < kSent);
  // The kernel tells its count with the next frame that it does queue.
  Frame last = makeFrame(0x111, 8);
  REQUIRE(there.send(last, 0) == SendResult::kSent);
  collect(here, 1);
  CHECK(here.statistics().receive_dropped == kSent - kept);
}

TEST_CASE("an interface that goes down and comes up again is served by the same socket") {
  SocketCanBus here(kInterface);
  SocketCanBus there(kInterface);
  if (!setUp(false)) {
    MESSAGE("not permitted to set the interface down: this case shows nothing");
    return;
  }
  Frame frame = makeFrame(0x080, 8);
  CHECK(here.send(frame, 0) == SendResult::kDown);
  CHECK(here.down());
  std::array<Frame, 4> frames;
  CHECK(there.receive(frames, 0) == 0);
  CHECK(there.down());
  CHECK_THROWS_AS(SocketCanBus{kInterface}, std::runtime_error);
  REQUIRE(setUp(true));
  CHECK(here.send(frame, 0) == SendResult::kSent);
  CHECK_FALSE(here.down());
  const std::vector<Frame> received = collect(there, 1);
  REQUIRE(received.size() == 1);
  CHECK_FALSE(there.down());
}

TEST_CASE("a full queue loses the command at once, and the bus goes on") {
  SocketCanBus here(kInterface);
  int full = 0;
  std::array<Frame, 64> frames;
  for (int i = 0; i < 5000; ++i) {
    Frame frame = makeFrame(0x080, 8);
    const SendResult result = here.send(frame, 0);
    CHECK(result != SendResult::kDown);
    if (result == SendResult::kQueueFull)
      ++full;
  }
  while (here.receive(frames, 0) > 0) {
  }
  CHECK(here.statistics().send_failed == static_cast<std::uint64_t>(full));
  CHECK(here.statistics().frames_sent + here.statistics().send_failed == 5000);
  Frame frame = makeFrame(0x080, 8);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  CHECK(here.send(frame, 0) == SendResult::kSent);
}

TEST_CASE("an interface that is no CAN interface is refused") {
  CHECK_THROWS_WITH_AS(SocketCanBus("lo"), "CAN interface 'lo': not a CAN interface", std::runtime_error);
  CHECK_THROWS_WITH_AS(SocketCanBus("nocan0"), "CAN interface 'nocan0': no such interface",
                       std::runtime_error);
}

int main(int argc, char** argv) {
  if (kInterface == nullptr) {
    std::printf("SKIPPED: PATELLA_CAN_INTERFACE names no interface\n");
    return kSkipped;
  }
  doctest::Context context(argc, argv);
  return context.run();
}
