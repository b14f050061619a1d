// What the loop hears of CANopen drives in its ticks, and what it sends them besides their commands.
#include "drivers/canopen/drive_nodes.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/unit/canopen/scripted_bus.hpp"

using namespace patella;
using namespace patella::canopen;
using namespace patella::test;
using safety::DriveFrames;
using safety::DrivePhase;
using safety::Fault;
using safety::FaultSet;

namespace {

CanopenMap twoNodes() {
  CanopenMap map;
  map.network = {.master_node = 100, .heartbeat_period_s = 0.005, .node_heartbeat_timeout_s = 0.03};
  map.drives.push_back({.joint = 0, .node = 4});
  map.drives.push_back({.joint = 1, .node = 9});
  return map;
}

/// Ticks of a millisecond; both nodes beat every ten.
struct Bench {
  FaultSet tick() {
    now_ns += 1'000'000;
    ++ticks;
    if (ticks % 10 == 0) {
      for (const unsigned node : {4U, 9U}) {
        if (node != quiet)
          nodes.accept(makeFrame(0x700 + node, {5}));
      }
    }
    return nodes.finish(now_ns, measurement);
  }
  FaultSet ticksOf(int count) {
    FaultSet faults;
    for (int i = 0; i < count; ++i)
      faults = faults | tick();
    return faults;
  }
  const NodeNotice& notice(std::size_t joint) const { return nodes.notices()[joint]; }

  DriveNodes nodes{twoNodes(), 1e-3};
  Measurement measurement;
  std::int64_t now_ns = 5'000'000'000;
  int ticks = 0;
  unsigned quiet = 0;
};

}  // namespace

TEST_CASE("without CANopen drives nothing is heard, sent or judged") {
  DriveNodes none;
  Measurement measurement;
  none.accept(makeFrame(0x080, {0x30, 0x81, 0x11}));
  CHECK_FALSE(none.any());
  CHECK_FALSE(none.finish(1, measurement).any());
  CHECK(std::isnan(measurement.drive_error[0]));
  CHECK(none.cycle().empty());
  CHECK(none.farewell().empty());
  CHECK_FALSE(none.reserved(makeFrame(0x000, {1, 0})));
  CHECK(none.controlword(4, DrivePhase::kIn, DriveFrames::kNone) == 0);
}

TEST_CASE("after each tick's commands comes SYNC, and every fifth time the loop's heartbeat") {
  Bench bench;
  int heartbeats = 0;
  for (int i = 0; i < 50; ++i) {
    const auto frames = bench.nodes.cycle();
    REQUIRE_FALSE(frames.empty());
    CHECK(frames[0].id == 0x080);
    CHECK(frames[0].length == 0);
    if (frames.size() == 2) {
      CHECK(i % 5 == 0);
      CHECK(frames[1].id == 0x764);
      CHECK(frames[1].length == 1);
      CHECK(frames[1].data[0] == 5);
      ++heartbeats;
    }
  }
  CHECK(heartbeats == 10);
}

TEST_CASE("controlwords follow the node's own status word, and how far it is to be led") {
  Bench bench;
  CHECK(bench.nodes.controlword(4, DrivePhase::kEntering, DriveFrames::kNone) == 0);
  bench.nodes.accept(makeFrame(0x184, {0x31, 0x02, 0, 0, 0, 0, 0, 0}));
  bench.nodes.accept(makeFrame(0x189, {0x37, 0x12, 0, 0, 0, 0, 0, 0}));
  CHECK(bench.nodes.controlword(4, DrivePhase::kEntering, DriveFrames::kNone) == 0x07);
  CHECK(bench.nodes.controlword(4, DrivePhase::kOut, DriveFrames::kNone) == 0x06);
  CHECK(bench.nodes.controlword(9, DrivePhase::kIn, DriveFrames::kNone) == 0x0F);
  CHECK(bench.nodes.controlword(9, DrivePhase::kLeaving, DriveFrames::kNone) == 0x06);
  bench.nodes.accept(makeFrame(0x184, {0x18, 0x02, 0, 0, 0, 0, 0, 0}));
  CHECK(bench.nodes.controlword(4, DrivePhase::kOut, DriveFrames::kNone) == 0x00);
  CHECK(bench.nodes.controlword(4, DrivePhase::kOut, DriveFrames::kClear) == 0x80);
  // One byte is no status word.
  bench.nodes.accept(makeFrame(0x184, {0x37}));
  CHECK(bench.nodes.controlword(4, DrivePhase::kIn, DriveFrames::kNone) == 0x00);
}

TEST_CASE("an emergency is a fault in its tick, and told with code and register") {
  Bench bench;
  CHECK_FALSE(bench.ticksOf(20).any());
  CHECK(bench.measurement.drive_error[1] == 0.0);
  bench.nodes.accept(makeFrame(0x089, {0x10, 0x43, 0x09, 0, 0, 0, 0, 0}));
  bench.nodes.accept(makeFrame(0x089, {0x00, 0x10, 0x01, 0, 0, 0, 0, 0}));
  CHECK(bench.tick() == FaultSet{Fault::kDriveEmergency});
  CHECK(bench.notice(0).kind == NoticeKind::kNone);
  CHECK(bench.notice(1).kind == NoticeKind::kEmergency);
  CHECK(bench.notice(1).node == 9);
  CHECK(bench.notice(1).code == 0x4310);  // the first of a tick is the cause
  CHECK(bench.notice(1).error_register == 0x09);
  CHECK(bench.measurement.drive_error[1] == 0x1000);
  CHECK_FALSE(bench.tick().any());
  CHECK(bench.notice(1).kind == NoticeKind::kNone);
  bench.nodes.accept(makeFrame(0x089, {0x00, 0x00, 0x00, 0, 0, 0, 0, 0}));
  CHECK_FALSE(bench.tick().any());
  CHECK(bench.measurement.drive_error[1] == 0.0);
  // Of a node that is nobody's drive.
  bench.nodes.accept(makeFrame(0x085, {0x10, 0x43, 0x09, 0, 0, 0, 0, 0}));
  CHECK_FALSE(bench.tick().any());
}

TEST_CASE("a missing heartbeat is a fault until it comes again") {
  Bench bench;
  CHECK_FALSE(bench.ticksOf(40).any());
  bench.quiet = 9;
  CHECK_FALSE(bench.ticksOf(30).any());
  CHECK(bench.tick() == FaultSet{Fault::kDriveOffline});
  CHECK(bench.notice(1).kind == NoticeKind::kSilent);
  CHECK(bench.tick() == FaultSet{Fault::kDriveOffline});
  CHECK(bench.notice(1).kind == NoticeKind::kNone);
  bench.quiet = 0;
  bench.ticksOf(10);
  CHECK_FALSE(bench.ticksOf(50).any());
}

TEST_CASE("no heartbeat from the beginning is one that is missing") {
  Bench bench;
  bench.quiet = 4;
  CHECK_FALSE(bench.ticksOf(31).any());
  CHECK(bench.tick().has(Fault::kDriveOffline));
}

TEST_CASE("a node that starts anew or leaves operational is offline for good, and gets no enable") {
  for (const unsigned state : {0x00U, 0x7FU, 0x04U}) {
    CAPTURE(state);
    Bench bench;
    bench.nodes.accept(makeFrame(0x184, {0x37, 0x12, 0, 0, 0, 0, 0, 0}));
    bench.ticksOf(20);
    CHECK(bench.nodes.controlword(4, DrivePhase::kIn, DriveFrames::kNone) == 0x0F);
    bench.nodes.accept(makeFrame(0x704, {state}));
    CHECK(bench.tick() == FaultSet{Fault::kDriveOffline});
    CHECK(bench.notice(0).kind == (state == 0 ? NoticeKind::kBootUp : NoticeKind::kState));
    CHECK(bench.notice(0).code == state);
    CHECK(bench.nodes.controlword(4, DrivePhase::kIn, DriveFrames::kNone) == 0x00);
    CHECK(bench.nodes.controlword(4, DrivePhase::kOut, DriveFrames::kClear) == 0x00);
    // Operational once more, by whomever: nothing of the set-up is known to be left.
    for (int i = 0; i < 100; ++i) {
      CHECK(bench.tick() == FaultSet{Fault::kDriveOffline});
    }
  }
}

TEST_CASE("what the loop alone may send is told from what nodes send") {
  const DriveNodes nodes(twoNodes(), 1e-3);
  for (const std::uint32_t id : {0x000U, 0x080U, 0x604U, 0x609U, 0x764U})
    CHECK(nodes.reserved(makeFrame(id, {0, 0})));
  for (const std::uint32_t id : {0x084U, 0x184U, 0x584U, 0x605U, 0x704U, 0x763U})
    CHECK_FALSE(nodes.reserved(makeFrame(id, {0, 0})));
  can::Frame extended = makeFrame(0x080, {});
  extended.extended = true;
  CHECK_FALSE(nodes.reserved(extended));
}

TEST_CASE("the farewell lets the drives do without the loop's heartbeat, and then be silent") {
  const DriveNodes nodes(twoNodes(), 1e-3);
  REQUIRE(nodes.farewell().size() == 4);
  const can::Frame off = makeFrame(0x604, {0x23, 0x16, 0x10, 1, 0, 0, 0, 0});
  CHECK(nodes.farewell()[0].id == off.id);
  CHECK(nodes.farewell()[0].data == off.data);
  CHECK(nodes.farewell()[1].id == 0);
  CHECK(nodes.farewell()[1].data[0] == 0x80);
  CHECK(nodes.farewell()[1].data[1] == 4);
}

TEST_CASE("load of SYNC and heartbeats") {
  can::BusLoad load;
  addCycleLoad(twoNodes(), 1000.0, load);
  CHECK(load.frames_per_s == doctest::Approx(1000 + 200 + 200));
  CHECK(load.bits_per_s ==
        doctest::Approx(1000 * can::mostBits(0, false, false) + 400 * can::mostBits(1, false, false)));
}
