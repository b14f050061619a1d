#include "drivers/canopen/node_setup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>

#include "drivers/can/bus_group.hpp"
#include "drivers/canopen/frame_wait.hpp"
#include "drivers/canopen/hexadecimal.hpp"
#include "drivers/canopen/network_frames.hpp"
#include "drivers/canopen/sdo_client.hpp"

namespace patella::canopen {
namespace {

constexpr double kRatedTolerance = 0.02;
constexpr double kModeTimeout_s = 0.5;
constexpr double kStartTimeout_s = 1.0;
constexpr std::uint32_t kTorqueMode = 10;
constexpr unsigned kTorqueModeBit = 9;
constexpr std::uint32_t kDriveProfile = 402;
constexpr std::uint32_t kPdoOff = 0x80000000;
constexpr std::uint32_t kNoRemote = 0x40000000;  // a TPDO that cannot be asked for by a remote request

/// An object in a PDO: index, sub-index and bits, as mapping entries have them.
constexpr std::uint32_t mapped(std::uint32_t index, std::uint32_t bits) noexcept {
  return index << 16U | bits;
}

constexpr std::array kCommandObjects{mapped(0x6040, 16), mapped(0x6071, 16)};
constexpr std::array kReportObjects{mapped(0x6041, 16), mapped(0x6077, 16), mapped(0x6064, 32)};

std::string shortNumber(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  return text.ends_with('.') ? text.substr(0, text.size() - 1) : text;
}

void send(can::Bus& bus, Clock& clock, NmtCommand command, const DriveSettings& drive) {
  can::Frame sent = nmtFrame(command, drive.node);
  sent.bus = drive.bus;
  if (bus.send(sent, clock.now()) != can::SendResult::kSent) {
    throw NodeError("node " + std::to_string(drive.node) +
                    ": a frame of network management could not be sent: the interface is down, or nobody "
                    "acknowledges on the bus");
  }
}

std::string deviceName(SdoClient& sdo) {
  constexpr std::uint16_t kDeviceName = 0x1008;
  try {
    const std::vector<std::uint8_t> bytes = sdo.read(kDeviceName);
    std::string name;
    for (const std::uint8_t byte : bytes) {
      if (byte >= 0x20 && byte < 0x7F) {
        name += static_cast<char>(byte);
      }
    }
    return name;
  } catch (const SdoAbort&) {
    return "";  // it is optional
  }
}

void requireIdentity(const SdoClient& sdo, std::uint8_t sub, std::uint32_t found, std::uint32_t expected,
                     const char* what) {
  if (expected != 0 && found != expected) {
    sdo.fail(0x1018, sub,
             std::string(what) + " " + hexadecimal(found, 8) + ", expected " + hexadecimal(expected, 8) +
                 " as its data sheet has it");
  }
}

void requireRatedTorque(const SdoClient& sdo, const DriveSettings& drive, double found_Nm) {
  if (std::abs(found_Nm - drive.rated_torque_Nm) <= kRatedTolerance * drive.rated_torque_Nm) {
    return;
  }
  sdo.fail(0x6076, 0,
           "rated torque " + shortNumber(found_Nm) + " N·m, read in " +
               (drive.rated_torque_unit_Nm > 1e-5 ? "mN·m" : "µN·m") + ", expected " +
               shortNumber(drive.rated_torque_Nm) +
               " N·m within 2 % as rated_torque_Nm says; a factor of 1000 is another rated_torque_unit");
}

/// Which drive it is: device type, vendor and product. Nothing that is written to a drive changes them.
NodeIdentity identify(SdoClient& sdo, const DriveSettings& drive) {
  NodeIdentity identity;
  identity.node = drive.node;
  const std::uint32_t type = sdo.number(0x1000, 0, 4);
  if ((type & 0xFFFFU) != kDriveProfile) {
    sdo.fail(0x1000, 0, "device type " + hexadecimal(type, 8) + ", expected one of CiA 402, xxxx0192h");
  }
  identity.name = deviceName(sdo);
  identity.vendor = sdo.number(0x1018, 1, 4);
  requireIdentity(sdo, 1, identity.vendor, drive.vendor, "vendor");
  const auto optional = [&sdo](std::uint8_t sub) {
    try {
      return sdo.number(0x1018, sub, 4);
    } catch (const SdoAbort&) {
      return std::uint32_t{0};
    }
  };
  identity.product = optional(2);
  requireIdentity(sdo, 2, identity.product, drive.product, "product");
  identity.revision = optional(3);
  identity.serial = optional(4);
  return identity;
}

/// What it can do: modes and rated torque, which may follow from the parameters of its DCF.
void askAbilities(SdoClient& sdo, const DriveSettings& drive, NodeIdentity& identity) {
  identity.modes = sdo.number(0x6502, 0, 4);
  if ((identity.modes >> kTorqueModeBit & 1U) == 0) {
    sdo.fail(
        0x6502, 0,
        "supported modes " + hexadecimal(identity.modes, 8) + ", expected bit 9, cyclic synchronous torque");
  }
  identity.rated_torque_Nm = drive.rated_torque_unit_Nm * sdo.number(0x6076, 0, 4);
  requireRatedTorque(sdo, drive, identity.rated_torque_Nm);
}

/// A PDO's communication and mapping parameters.
struct Pdo {
  std::uint16_t communication;
  std::uint16_t mapping;
  std::uint32_t id;
  std::uint8_t type;
  std::span<const std::uint32_t> objects;
};

// A PDO may be changed only while it is off, and its mapping only while it has no entries.
void setUpPdo(SdoClient& sdo, const Pdo& pdo, std::uint32_t flags) {
  sdo.write({pdo.communication, 1, 4, kPdoOff | flags | pdo.id});
  sdo.write({pdo.mapping, 0, 1, 0});
  std::uint8_t entry = 0;
  for (const std::uint32_t object : pdo.objects) {
    sdo.write({pdo.mapping, ++entry, 4, object});
  }
  sdo.write({pdo.mapping, 0, 1, entry});
  sdo.write({pdo.communication, 2, 1, pdo.type});
  sdo.write({pdo.communication, 1, 4, flags | pdo.id});
}

// What a maker has switched on besides would load the bus, or hear somebody else.
void switchOffOthers(SdoClient& sdo) {
  for (const std::uint16_t first : {std::uint16_t{0x1401}, std::uint16_t{0x1801}}) {
    for (std::uint16_t index = first; index < first + 3; ++index) {
      try {
        const std::uint32_t id = sdo.number(index, 1, 4);
        if ((id & kPdoOff) == 0) {
          sdo.write({index, 1, 4, id | kPdoOff});
        }
      } catch (const SdoAbort& abort) {
        if (!abort.absent()) {
          throw;
        }
      }
    }
  }
}

void setUpPdos(SdoClient& sdo) {
  // After the command's identifier a controller that sorts its mailboxes sends SYNC first: so a command acts
  // when it comes (type 255), and a report is that of the SYNC (type 1).
  constexpr std::uint8_t kAtOnce = 255;
  constexpr std::uint8_t kEachSync = 1;
  setUpPdo(sdo, {0x1400, 0x1600, commandId(sdo.node()), kAtOnce, kCommandObjects}, 0);
  // Some servers insist on the bit by which a TPDO cannot be asked for: it stays as it is.
  const std::uint32_t flags = sdo.number(0x1800, 1, 4) & kNoRemote;
  setUpPdo(sdo, {0x1800, 0x1A00, reportId(sdo.node()), kEachSync, kReportObjects}, flags);
  switchOffOthers(sdo);
}

void setMode(SdoClient& sdo, Clock& clock) {
  constexpr std::int64_t kLook_ns = 10'000'000;
  sdo.write({0x6060, 0, 1, kTorqueMode});
  const std::int64_t end_ns = clock.now() + std::llround(1e9 * kModeTimeout_s);
  std::uint32_t mode = sdo.number(0x6061, 0, 1);
  while (mode != kTorqueMode && clock.now() < end_ns) {
    clock.sleepUntil(clock.now() + kLook_ns);
    mode = sdo.number(0x6061, 0, 1);
  }
  if (mode != kTorqueMode) {
    sdo.fail(0x6061, 0,
             "mode " + std::to_string(static_cast<std::int8_t>(mode)) +
                 ", expected 10, cyclic synchronous torque, within 0.5 s of having been set");
  }
}

// Some drives have it fixed, or not at all: then the value has to be right, or is nobody's concern.
void setInterpolationTime(SdoClient& sdo, const InterpolationTime& time) {
  const std::array<std::uint32_t, 2> wanted = {time.value, static_cast<std::uint8_t>(time.exponent)};
  for (std::uint8_t sub = 1; sub <= 2; ++sub) {
    try {
      if (sdo.number(0x60C2, sub, 1) != wanted[sub - 1U]) {
        sdo.write({0x60C2, sub, 1, wanted[sub - 1U]});
      }
    } catch (const SdoAbort& abort) {
      if (!abort.absent()) {
        throw;
      }
    }
  }
}

std::uint32_t milliseconds(double seconds) noexcept {
  return static_cast<std::uint32_t>(std::max(std::lround(1e3 * seconds), 1L));
}

void setUpNode(can::Bus& buses, Clock& clock, const NetworkSettings& network, const DriveSettings& drive,
               const InterpolationTime& time, NodeIdentity& identity) {
  can::OneOfBuses bus(buses, drive.bus);
  SdoClient sdo(bus, clock, drive.node);
  for (const ObjectValue& parameter : drive.parameters) {
    sdo.write(parameter);
  }
  askAbilities(sdo, drive, identity);
  sdo.write({0x6040, 0, 2, 0});  // whatever a run before has left
  sdo.write({0x6071, 0, 2, 0});
  setUpPdos(sdo);
  setMode(sdo, clock);
  setInterpolationTime(sdo, time);
  sdo.write({0x1017, 0, 2, milliseconds(network.node_heartbeat_period_s)});
  sdo.write(
      {0x1016, 1, 4,
       static_cast<std::uint32_t>(network.master_node) << 16U | milliseconds(network.heartbeat_timeout_s)});
}

void awaitOperational(can::Bus& buses, Clock& clock, const DriveSettings& drive) {
  const int node = drive.node;
  can::OneOfBuses bus(buses, drive.bus);
  std::uint8_t state = 0xFF;
  const auto take = [&](const can::Frame& frame) {
    if (!isStandard(frame) || frame.id != heartbeatId(node) || frame.length < 1) {
      return false;
    }
    state = frame.data[0];
    return state == kOperationalState;
  };
  if (!waitForFrame(bus, clock, kStartTimeout_s, take)) {
    throw NodeError("node " + std::to_string(node) + ": " +
                    (state == 0xFF ? std::string("no heartbeat") : "state " + hexadecimal(state, 2)) +
                    " within 1 s of its start, expected 05h, operational");
  }
}

}  // namespace

std::string identityText(const NodeIdentity& identity) {
  return "node " + std::to_string(identity.node) + ": '" + identity.name + "', vendor " +
         hexadecimal(identity.vendor, 8) + ", product " + hexadecimal(identity.product, 8) + ", revision " +
         hexadecimal(identity.revision, 8) + ", serial " + hexadecimal(identity.serial, 8) +
         ", rated torque " + shortNumber(identity.rated_torque_Nm) + " N·m";
}

InterpolationTime interpolationTime(double period_s) {
  constexpr double kRounding = 1e-6;
  constexpr int kFinest = -6;
  double unit_s = 1e-3;
  for (int exponent = -3; exponent >= kFinest; --exponent, unit_s /= 10.0) {
    const double value = std::round(period_s / unit_s);
    if (value >= 1.0 && value <= 255.0 && std::abs(value * unit_s - period_s) <= kRounding * period_s) {
      return {static_cast<std::uint8_t>(value), static_cast<std::int8_t>(exponent)};
    }
  }
  throw std::invalid_argument("the loop's period is " + std::to_string(period_s) +
                              " s, expected one of 1 to 255 ms, or that many times 100, 10 or 1 µs, as "
                              "CiA 402 drives can be told (60C2h)");
}

NodeIdentity askNode(can::Bus& buses, Clock& clock, const DriveSettings& drive) {
  can::OneOfBuses bus(buses, drive.bus);
  SdoClient sdo(bus, clock, drive.node);
  NodeIdentity identity = identify(sdo, drive);
  askAbilities(sdo, drive, identity);
  return identity;
}

std::vector<NodeIdentity> setUpNodes(can::Bus& buses, Clock& clock, const CanopenMap& map, double period_s) {
  const InterpolationTime time = interpolationTime(period_s);
  for (const DriveSettings& drive : map.drives) {
    send(buses, clock, NmtCommand::kPreOperational, drive);
  }
  // Who each of them is comes before the first write: parameters of one drive in another would stay there.
  std::vector<NodeIdentity> identities;
  for (const DriveSettings& drive : map.drives) {
    can::OneOfBuses bus(buses, drive.bus);
    SdoClient sdo(bus, clock, drive.node);
    identities.push_back(identify(sdo, drive));
  }
  for (std::size_t i = 0; i < map.drives.size(); ++i) {
    setUpNode(buses, clock, map.network, map.drives[i], time, identities[i]);
  }
  // All of them at the end: the first would wait for its SYNC while the last is still set up.
  for (const DriveSettings& drive : map.drives) {
    send(buses, clock, NmtCommand::kStart, drive);
  }
  for (const DriveSettings& drive : map.drives) {
    awaitOperational(buses, clock, drive);
  }
  return identities;
}

}  // namespace patella::canopen
