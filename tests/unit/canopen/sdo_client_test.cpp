// Reading and writing by SDO, byte by byte, and what a node may answer instead.
#include "drivers/canopen/sdo_client.hpp"

#include <string>

#include <doctest/doctest.h>

#include "drivers/clock/clock.hpp"
#include "tests/unit/canopen/scripted_bus.hpp"

using namespace patella;
using namespace patella::canopen;
using namespace patella::test;

namespace {

/// Node 5, and what it answers to each request in turn.
struct Bench {
  explicit Bench(std::vector<can::Frame> answers) {
    bus.answer = [answers, next = std::size_t{0}](const can::Frame&,
                                                  std::deque<can::Frame>& waiting) mutable {
      if (next < answers.size() && answers[next].length > 0)
        waiting.push_back(answers[next]);
      ++next;
    };
  }
  ScriptedBus bus;
  VirtualClock clock;
  SdoClient sdo{bus, clock, 5};
};

std::string failure(const std::function<void()>& act) {
  try {
    act();
  } catch (const NodeError& error) {
    return error.what();
  }
  return "";
}

bool sameBytes(const can::Frame& frame, std::initializer_list<unsigned> bytes) {
  const can::Frame expected = makeFrame(frame.id, bytes);
  return frame.length == expected.length && frame.data == expected.data;
}

}  // namespace

TEST_CASE("expedited answers of 1, 2, 3 and 4 bytes, and one that does not state its size") {
  struct Row {
    unsigned command;
    int bytes;
    std::uint32_t expected;
  };
  for (const Row& row : {Row{0x4F, 1, 0x78}, Row{0x4B, 2, 0x5678}, Row{0x43, 4, 0x12345678},
                         Row{0x42, 4, 0x12345678}, Row{0x42, 2, 0x5678}, Row{0x47, 2, 0x5678}}) {
    CAPTURE(row.command);
    Bench bench({makeFrame(0x585, {row.command, 0x64, 0x60, 0, 0x78, 0x56, 0x34, 0x12})});
    CHECK(bench.sdo.number(0x6064, 0, row.bytes) == row.expected);
    REQUIRE(bench.bus.sent.size() == 1);
    CHECK(bench.bus.sent[0].id == 0x605);
    CHECK(sameBytes(bench.bus.sent[0], {0x40, 0x64, 0x60, 0, 0, 0, 0, 0}));
  }
  Bench bench({makeFrame(0x585, {0x4F, 0x64, 0x60, 0, 0x78, 0, 0, 0})});
  CHECK(failure([&] { bench.sdo.number(0x6064, 0, 4); }) ==
        "node 5: 6064h: answer of 1 bytes, expected a number of 4");
}

TEST_CASE("writing 1, 2 and 4 bytes") {
  Bench bench({makeFrame(0x585, {0x60, 0x60, 0x60, 0, 0, 0, 0, 0}),
               makeFrame(0x585, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0}),
               makeFrame(0x585, {0x60, 0x16, 0x10, 1, 0, 0, 0, 0})});
  bench.sdo.write({0x6060, 0, 1, 10});
  bench.sdo.write({0x1017, 0, 2, 500});
  bench.sdo.write({0x1016, 1, 4, 0x007F0014});
  REQUIRE(bench.bus.sent.size() == 3);
  CHECK(sameBytes(bench.bus.sent[0], {0x2F, 0x60, 0x60, 0, 0x0A, 0, 0, 0}));
  CHECK(sameBytes(bench.bus.sent[1], {0x2B, 0x17, 0x10, 0, 0xF4, 0x01, 0, 0}));
  CHECK(sameBytes(bench.bus.sent[2], {0x23, 0x16, 0x10, 1, 0x14, 0x00, 0x7F, 0x00}));
}

TEST_CASE("text comes in segments, toggled, the last one shorter") {
  Bench bench({makeFrame(0x585, {0x41, 0x08, 0x10, 0, 10, 0, 0, 0}),
               makeFrame(0x585, {0x00, 'E', 'P', 'O', 'S', '4', ' ', 'C'}),
               makeFrame(0x585, {0x19, 'o', 'm', 'p', 0, 0, 0, 0})});
  const std::vector<std::uint8_t> data = bench.sdo.read(0x1008);
  CHECK(std::string(data.begin(), data.end()) == "EPOS4 Comp");
  REQUIRE(bench.bus.sent.size() == 3);
  CHECK(sameBytes(bench.bus.sent[1], {0x60, 0, 0, 0, 0, 0, 0, 0}));
  CHECK(sameBytes(bench.bus.sent[2], {0x70, 0, 0, 0, 0, 0, 0, 0}));
  Bench endless({makeFrame(0x585, {0x41, 0x08, 0x10, 0, 0, 2, 0, 0})});
  CHECK(failure([&] { endless.sdo.read(0x1008); }) ==
        "node 5: 1008h: answer of 512 bytes, expected at most 256");
}

TEST_CASE("an abort is named by code and text") {
  Bench bench({makeFrame(0x585, {0x80, 0x60, 0x60, 0, 0x30, 0x00, 0x09, 0x06}),
               makeFrame(0x585, {0x80, 0x18, 0x10, 4, 0x11, 0x00, 0x09, 0x06}),
               makeFrame(0x585, {0x80, 0x00, 0x20, 0, 0x78, 0x56, 0x34, 0x12})});
  CHECK(failure([&] {
          bench.sdo.write({0x6060, 0, 1, 10});
        }) == "node 5: 6060h: aborted with 06090030h, value out of range");
  try {
    bench.sdo.number(0x1018, 4, 4);
    CHECK(false);
  } catch (const SdoAbort& abort) {
    CHECK(abort.absent());
    CHECK(abort.code() == 0x06090011);
    CHECK(std::string(abort.what()) == "node 5: 1018h:4: aborted with 06090011h, sub-index does not exist");
  }
  CHECK(failure([&] { bench.sdo.number(0x2000, 0, 1); }) ==
        "node 5: 2000h: aborted with 12345678h, unknown code");
}

TEST_CASE("a node that does not answer is asked three times, 0.5 s each, and told that it is over") {
  Bench bench({});
  CHECK(failure([&] {
          bench.sdo.number(0x1000, 0, 4);
        }).starts_with("node 5: 1000h: no answer within 0.5 s, asked 3 times; expected a node that is on"));
  CHECK(bench.clock.now() >= 1'500'000'000);
  CHECK(bench.clock.now() <= 1'510'000'000);
  REQUIRE(bench.bus.sent.size() == 4);
  CHECK(sameBytes(bench.bus.sent[3], {0x80, 0x00, 0x10, 0, 0x00, 0x00, 0x04, 0x05}));
  const can::Frame late = makeFrame(0x585, {0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00});
  Bench second({can::Frame{}, late});
  CHECK(second.sdo.number(0x1000, 0, 4) == 0x00020192);
  CHECK(second.bus.sent.size() == 2);
}

TEST_CASE("answers for others, of others and to what was asked before are passed over") {
  ScriptedBus bus;
  bus.answer = [](const can::Frame&, std::deque<can::Frame>& waiting) {
    waiting.push_back(makeFrame(0x586, {0x43, 0x00, 0x10, 0, 1, 0, 0, 0}));
    waiting.push_back(makeFrame(0x585, {0x43, 0x18, 0x10, 1, 2, 0, 0, 0}));
    waiting.push_back(makeFrame(0x585, {0x60, 0x00, 0x10, 0, 0, 0, 0, 0}));
    waiting.push_back(makeFrame(0x585, {0x80, 0x18, 0x10, 1, 0, 0, 2, 6}));
    waiting.push_back(makeFrame(0x585, {0x43, 0x00, 0x10}));
    waiting.push_back(makeFrame(0x705, {0x7F}));
    waiting.push_back(makeFrame(0x585, {0x43, 0x00, 0x10, 0, 3, 0, 0, 0}));
  };
  VirtualClock clock;
  SdoClient sdo(bus, clock, 5);
  CHECK(sdo.number(0x1000, 0, 4) == 3);
}

TEST_CASE("a bus on which nothing goes out is said to be one") {
  Bench bench({});
  bench.bus.result = can::SendResult::kQueueFull;
  CHECK(failure([&] {
          bench.sdo.number(0x1000, 0, 4);
        }).ends_with("the request could not be sent: nobody acknowledges on the bus"));
  bench.bus.result = can::SendResult::kDown;
  CHECK(failure([&] { bench.sdo.number(0x1000, 0, 4); }) == "node 5: 1000h: the interface is down");
}
