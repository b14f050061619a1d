// Setting drives up: each object that is written, in its order, and every way in which a drive is not the one
// that was configured.
#include "drivers/canopen/node_setup.hpp"

#include <algorithm>
#include <map>
#include <string>

#include <doctest/doctest.h>

#include "drivers/canopen/sdo_client.hpp"
#include "tests/unit/canopen/drive_bench.hpp"
#include "tests/unit/canopen/scripted_bus.hpp"

using namespace patella;
using namespace patella::canopen;
using namespace patella::test;

namespace {

struct Written {
  unsigned index;
  unsigned sub;
  std::uint32_t value;
  bool operator==(const Written&) const = default;
};

/// Expedited downloads to a node.
std::vector<Written> writtenTo(const DriveBench& bench, std::uint32_t node) {
  std::vector<Written> written;
  for (const can::Frame& frame : bench.sent) {
    if (frame.id == 0x600 + node && (frame.data[0] & 0xE0U) == 0x20) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i)
        value |= static_cast<std::uint32_t>(frame.data[4 + i]) << (8U * i);
      written.push_back({frame.data[1] | static_cast<unsigned>(frame.data[2]) << 8U, frame.data[3], value});
    }
  }
  return written;
}

std::vector<NodeIdentity> setUp(DriveBench& bench, const std::vector<DriveSettings>& drives) {
  VirtualClock clock;
  return setUpNodes(bench, clock, {.network = {}, .drives = drives}, 1e-3);
}

std::string failure(const sim::FieldDriveOptions& options, const DriveSettings& settings,
                    const sim::FieldDriveDefect& defect = {}) {
  DriveBench bench({options});
  bench.drives[0]->defect(defect, 0);
  try {
    setUp(bench, {settings});
  } catch (const NodeError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("everything that a drive is told, in this order") {
  DriveBench bench({simulatedNode(3)});
  const std::vector<NodeIdentity> identities = setUp(bench, {settingsOf(simulatedNode(3), 0)});
  REQUIRE(identities.size() == 1);
  CHECK(identities[0].name == "Patella rig drive");
  CHECK(identities[0].rated_torque_Nm == doctest::Approx(0.5));
  CHECK(identityText(identities[0]) ==
        "node 3: 'Patella rig drive', vendor 0000CAFEh, product 00000402h, revision 00010000h, serial "
        "00000003h, rated torque 0.5 N·m");
  const std::vector<Written> expected = {
      {0x6040, 0, 0},          {0x6071, 0, 0},          {0x1400, 1, 0x80000203}, {0x1600, 0, 0},
      {0x1600, 1, 0x60400010}, {0x1600, 2, 0x60710010}, {0x1600, 0, 2},          {0x1400, 2, 255},
      {0x1400, 1, 0x203},      {0x1800, 1, 0xC0000183}, {0x1A00, 0, 0},          {0x1A00, 1, 0x60410010},
      {0x1A00, 2, 0x60770010}, {0x1A00, 3, 0x60640020}, {0x1A00, 0, 3},          {0x1800, 2, 1},
      {0x1800, 1, 0x40000183}, {0x1401, 1, 0x80000303}, {0x1801, 1, 0xC0000283}, {0x6060, 0, 10},
      {0x60C2, 1, 1},          {0x1017, 0, 10},         {0x1016, 1, 0x007F0014}};
  CHECK(writtenTo(bench, 3) == expected);
  REQUIRE(bench.sent.size() > 2);
  const auto nmt = [&](std::size_t at, unsigned command) {
    return bench.sent[at].id == 0 && bench.sent[at].length == 2 && bench.sent[at].data[0] == command &&
           bench.sent[at].data[1] == 3;
  };
  CHECK(nmt(0, 0x80));
  CHECK(nmt(bench.sent.size() - 1, 0x01));
}

TEST_CASE("drives start together, after the last is set up; parameters come first") {
  DriveBench bench({simulatedNode(3), simulatedNode(4)});
  DriveSettings second = settingsOf(simulatedNode(4), 1);
  second.parameters = {{0x6072, 0, 2, 1500}};
  CHECK(setUp(bench, {settingsOf(simulatedNode(3), 0), second}).size() == 2);
  CHECK(writtenTo(bench, 4).front() == Written{0x6072, 0, 1500});
  std::vector<std::size_t> starts;
  std::size_t last_request = 0;
  for (std::size_t i = 0; i < bench.sent.size(); ++i) {
    if (bench.sent[i].id == 0 && bench.sent[i].data[0] == 1)
      starts.push_back(i);
    last_request = bench.sent[i].id >= 0x600 ? i : last_request;
  }
  REQUIRE(starts.size() == 2);
  CHECK(starts[0] > last_request);
}

TEST_CASE("a drive that is set up obeys commands and reports at SYNC, and another set-up finds it as it is") {
  DriveBench bench({simulatedNode(3)});
  VirtualClock clock;
  const CanopenMap map{.network = {}, .drives = {settingsOf(simulatedNode(3), 0)}};
  setUpNodes(bench, clock, map, 1e-3);
  setUpNodes(bench, clock, map, 1e-3);
  bench.sink.waiting.clear();
  can::Frame command = makeFrame(0x203, {0x06, 0x00, 0x00, 0x00});
  bench.send(command, clock.now());
  can::Frame sync = makeFrame(0x080, {});
  bench.send(sync, clock.now());
  const auto report = std::find_if(bench.sink.waiting.begin(), bench.sink.waiting.end(),
                                   [](const can::Frame& frame) { return frame.id == 0x183; });
  REQUIRE(report != bench.sink.waiting.end());
  CHECK(report->length == 8);
  CHECK((report->data[0] & 0x6FU) == 0x21);
}

TEST_CASE("a drive that is not the configured one is refused with what it is") {
  const DriveSettings good = settingsOf(simulatedNode(3), 0);
  CHECK(failure(simulatedNode(3), good).empty());
  DriveSettings other = good;
  other.vendor = 0xFB;
  CHECK(failure(simulatedNode(3), other) ==
        "node 3: 1018h:1: vendor 0000CAFEh, expected 000000FBh as its data sheet has it");
  other = good;
  other.product = 0x1234;
  CHECK(failure(simulatedNode(3), other) ==
        "node 3: 1018h:2: product 00000402h, expected 00001234h as its data sheet has it");
  other = good;
  other.rated_torque_Nm = 0.511;
  CHECK(failure(simulatedNode(3), other) ==
        "node 3: 6076h: rated torque 0.5 N·m, read in mN·m, expected 0.511 N·m within 2 % as rated_torque_Nm "
        "says; "
        "a factor of 1000 is another rated_torque_unit");
  other.rated_torque_Nm = 0.509;
  CHECK(failure(simulatedNode(3), other).empty());
  other = good;
  other.rated_torque_unit_Nm = 1e-6;
  CHECK(failure(simulatedNode(3), other).find("rated torque 0.0005 N·m, read in µN·m, expected 0.5") !=
        std::string::npos);
  CHECK(failure(simulatedNode(3), good, {.wrong_rating = true}).find("rated torque 500 N·m") !=
        std::string::npos);
  sim::FieldDriveOptions micro = simulatedNode(3);
  micro.rated_torque_unit_Nm = 1e-6;
  CHECK(failure(micro, settingsOf(micro, 0)).empty());
}

TEST_CASE("where one node is another drive than configured, nothing is written to any") {
  const auto refused = [](void (*change)(DriveSettings&)) {
    DriveBench bench({simulatedNode(3), simulatedNode(4)});
    DriveSettings first = settingsOf(simulatedNode(3), 0);
    DriveSettings second = settingsOf(simulatedNode(4), 1);
    first.parameters = second.parameters = {{0x6072, 0, 2, 1500}};
    change(second);
    CHECK_THROWS_AS(setUp(bench, {first, second}), NodeError);
    return bench;
  };
  for (const auto change : {+[](DriveSettings& drive) { drive.vendor = 0xFB; },
                            +[](DriveSettings& drive) { drive.product = 0x1234; }}) {
    const DriveBench bench = refused(change);
    CHECK(writtenTo(bench, 3).empty());
    CHECK(writtenTo(bench, 4).empty());
  }
  // The rated torque is that of the motor, which parameters may set.
  const DriveBench bench = refused([](DriveSettings& drive) { drive.rated_torque_Nm = 0.6; });
  CHECK(writtenTo(bench, 4) == std::vector<Written>{{0x6072, 0, 1500}});
}

TEST_CASE("a drive that refuses, is silent or has another number is told of by node and object") {
  const DriveSettings good = settingsOf(simulatedNode(3), 0);
  CHECK(
      failure(simulatedNode(3), good, {.aborts_sdo = true}) ==
      "node 3: 6040h: aborted with 08000022h, data cannot be transferred in the present state of the device");
  CHECK(
      failure(simulatedNode(3), good, {.silent = true}).starts_with("node 3: 1000h: no answer within 0.5 s"));
  CHECK(failure(simulatedNode(4), good).starts_with("node 3: 1000h: no answer within 0.5 s"));
  DriveSettings unknown = good;
  unknown.parameters = {{0x2000, 1, 1, 7}};
  CHECK(failure(simulatedNode(3), unknown) ==
        "node 3: 2000h:1: aborted with 06020000h, object does not exist in the object dictionary");
}

TEST_CASE("a drive that does not start is told of by its state") {
  DriveBench bench({simulatedNode(3)});
  bench.keep_back = [](const can::Frame& frame) { return frame.id == 0 && frame.data[0] == 1; };
  CHECK_THROWS_WITH_AS(setUp(bench, {settingsOf(simulatedNode(3), 0)}),
                       "node 3: state 7Fh within 1 s of its start, expected 05h, operational", NodeError);
}

TEST_CASE("answers that another device gives: no drive, another profile, no torque mode, a mode that stays") {
  std::map<std::uint32_t, std::uint32_t> values = {{0x100000, 0x00020192}, {0x101801, 1}, {0x650200, 0x200},
                                                   {0x607600, 500},        {0x606100, 8}, {0x180001, 0x183}};
  std::size_t writes = 0;
  const auto act = [&values, &writes]() -> std::string {
    ScriptedBus bus;
    writes = 0;
    bus.answer = [&values, &writes](const can::Frame& request, std::deque<can::Frame>& waiting) {
      if (request.id != 0x603)
        return;
      can::Frame answer = request;
      answer.id = 0x583;
      const std::uint32_t place = request.data[2] << 16U | request.data[1] << 8U | request.data[3];
      if ((request.data[0] & 0xE0U) == 0x20) {
        ++writes;
        answer.data[0] = 0x60;
      } else if (const auto found = values.find(place); found != values.end()) {
        answer.data[0] = 0x42;
        for (std::size_t i = 0; i < 4; ++i)
          answer.data[4 + i] = static_cast<std::uint8_t>(found->second >> (8U * i));
      } else {
        answer.data =
            makeFrame(0, {0x80, request.data[1], request.data[2], request.data[3], 0, 0, 2, 6}).data;
      }
      waiting.push_back(answer);
    };
    VirtualClock clock;
    DriveSettings drive = settingsOf(simulatedNode(3), 0);
    drive.parameters = {{0x2000, 0, 1, 7}};
    try {
      setUpNodes(bus, clock, {.network = {}, .drives = {drive}}, 1e-3);
    } catch (const NodeError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(act() ==
        "node 3: 6061h: mode 8, expected 10, cyclic synchronous torque, within 0.5 s of having been set");
  values[0x606100] = 10;
  CHECK(act() == "node 3: no heartbeat within 1 s of its start, expected 05h, operational");
  values[0x650200] = 0x1AD;
  CHECK(act() == "node 3: 6502h: supported modes 000001ADh, expected bit 9, cyclic synchronous torque");
  values[0x100000] = 0x00000191;
  CHECK(act() == "node 3: 1000h: device type 00000191h, expected one of CiA 402, xxxx0192h");
  CHECK(writes == 0);
}

TEST_CASE("periods that 60C2h can hold") {
  const auto same = [](double period_s, int value, int exponent) {
    const InterpolationTime time = interpolationTime(period_s);
    return time.value == value && time.exponent == exponent;
  };
  CHECK(same(0.001, 1, -3));
  CHECK(same(0.002, 2, -3));
  CHECK(same(0.02, 20, -3));
  CHECK(same(0.0005, 5, -4));
  CHECK(same(0.00025, 25, -5));
  CHECK(same(0.000125, 125, -6));
  CHECK_THROWS_WITH_AS(interpolationTime(1.0 / 3000.0), doctest::Contains("expected one of 1 to 255 ms"),
                       std::invalid_argument);
}
