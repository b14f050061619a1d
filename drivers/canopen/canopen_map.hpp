// What configuration states of a CANopen network and of the CiA 402 drives on it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace patella::canopen {

/// A value for one entry of a node's object dictionary.
struct ObjectValue {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  int bytes = 4;  ///< 1, 2 or 4
  std::uint32_t value = 0;
};

struct NetworkSettings {
  int master_node = 127;                   ///< whose heartbeat the loop sends
  double heartbeat_period_s = 0.005;       ///< of the loop's own
  double heartbeat_timeout_s = 0.02;       ///< without it a drive stops by itself (1016h)
  double node_heartbeat_period_s = 0.01;   ///< of the drives (1017h)
  double node_heartbeat_timeout_s = 0.03;  ///< without it the loop stops
};

/// One drive in cyclic synchronous torque. Torque of the joint, N·m = direction · gear · rated torque · per
/// mille / 1000; angle = direction · 2π · counts / (gear · counts of a turn) + zero angle.
struct DriveSettings {
  int joint = 0;  ///< from 0
  int node = 1;
  std::uint8_t bus = 0;                   ///< of the loop's buses, from 0
  double rated_torque_Nm = 0.0;           ///< of the motor, before its gear
  double rated_torque_unit_Nm = 0.001;    ///< of 6076h, which makers read differently
  double gear = 1.0;                      ///< turns of the motor for one of the joint
  int direction = 1;                      ///< −1: the motor turns against the joint
  double counts_per_turn = 0.0;           ///< of 6064h, a turn of the motor
  double zero_angle_rad = 0.0;            ///< of the joint, where 6064h is 0
  double enter_timeout_s = 0.5;           ///< to operation enabled: a brake needs its time
  std::uint32_t vendor = 0;               ///< of 1018h:1; 0: any
  std::uint32_t product = 0;              ///< of 1018h:2; 0: any
  std::vector<ObjectValue> parameters{};  ///< written before anything else, in this order
  std::string origin{};                   ///< where it was written, "file:line: key 'cia402[1]'"
};

struct CanopenMap {
  NetworkSettings network;
  std::vector<DriveSettings> drives;

  bool any() const noexcept { return !drives.empty(); }
};

/// Identifiers of CiA 301's predefined connection set.
inline constexpr std::uint32_t kNmtId = 0x000;
inline constexpr std::uint32_t kSyncId = 0x080;
constexpr std::uint32_t emergencyId(int node) noexcept {
  return 0x080 + static_cast<std::uint32_t>(node);
}
constexpr std::uint32_t reportId(int node) noexcept {  // TPDO1
  return 0x180 + static_cast<std::uint32_t>(node);
}
constexpr std::uint32_t commandId(int node) noexcept {  // RPDO1
  return 0x200 + static_cast<std::uint32_t>(node);
}
constexpr std::uint32_t sdoAnswerId(int node) noexcept {
  return 0x580 + static_cast<std::uint32_t>(node);
}
constexpr std::uint32_t sdoRequestId(int node) noexcept {
  return 0x600 + static_cast<std::uint32_t>(node);
}
constexpr std::uint32_t heartbeatId(int node) noexcept {
  return 0x700 + static_cast<std::uint32_t>(node);
}

/// Commands of NMT, and states that heartbeats tell.
enum class NmtCommand : std::uint8_t { kStart = 0x01, kPreOperational = 0x80 };
inline constexpr std::uint8_t kBootUpState = 0x00;
inline constexpr std::uint8_t kOperationalState = 0x05;

}  // namespace patella::canopen
