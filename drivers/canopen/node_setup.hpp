// Makes drives of CiA 402 ready for cyclic synchronous torque, before the first tick: blocking, with words
// for whatever is not as it should be.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/can/bus.hpp"
#include "drivers/canopen/canopen_map.hpp"
#include "drivers/clock/clock.hpp"

namespace patella::canopen {

/// What a node says of itself.
struct NodeIdentity {
  int node = 0;
  std::string name;  ///< 1008h; empty where it has none
  std::uint32_t vendor = 0, product = 0, revision = 0, serial = 0;
  std::uint32_t modes = 0;       ///< 6502h
  double rated_torque_Nm = 0.0;  ///< 6076h in the configured unit
};

/// "node 1: 'EPOS4', vendor 000000FBh, …", for people.
std::string identityText(const NodeIdentity& identity);

/// 60C2h: a period is value · 10^exponent s.
struct InterpolationTime {
  std::uint8_t value = 1;
  std::int8_t exponent = -3;
};
/// Throws std::invalid_argument for a period that no such pair gives.
InterpolationTime interpolationTime(double period_s);

/// Reads, and changes nothing: device type, identity, modes and rated torque are those of a drive that can be
/// used as configured, or NodeError says what is not.
NodeIdentity askNode(can::Bus& buses, Clock& clock, const DriveSettings& drive);

/// Sets every drive up for a SYNC each period and starts it: parameters of its DCF, PDOs, mode, heartbeats. A
/// drive holds no torque and no enable then. Throws NodeError naming node and object. Where a node is another
/// drive than configured, nothing has been written to any.
std::vector<NodeIdentity> setUpNodes(can::Bus& buses, Clock& clock, const CanopenMap& map, double period_s);

}  // namespace patella::canopen
