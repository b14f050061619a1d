// CiA 402 drives in a tick: their states and heartbeats, the controlwords that lead them on, SYNC and the
// loop's own heartbeat.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/measurement.hpp"
#include "core/safety/drive_entry.hpp"
#include "core/safety/fault.hpp"
#include "core/types.hpp"
#include "drivers/can/bus_load.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/canopen/canopen_map.hpp"
#include "drivers/canopen/emergency.hpp"

namespace patella::canopen {

/// Notices of one tick, one place for each drive.
using NodeNotices = std::array<NodeNotice, kMaxJoints>;

class DriveNodes {
 public:
  /// Without drives of the kind nothing is heard, sent or judged. `period_s` between two ticks.
  explicit DriveNodes(const CanopenMap& map = {}, double period_s = 1e-3);

  bool any() const noexcept { return !nodes_.empty(); }

  /// Takes one frame, in order of arrival.
  void accept(const can::Frame& frame) noexcept PATELLA_NONBLOCKING;
  /// True for a frame that the loop alone may send: network management, SYNC, its heartbeat, SDO requests.
  bool reserved(const can::Frame& frame) const noexcept PATELLA_NONBLOCKING;

  /// Ends the tick's intake. kDriveEmergency in the tick that hears one. kDriveOffline as long as a heartbeat
  /// is missing, and for good once a node has started anew or left operational: what the set-up wrote is gone
  /// then. The newest code of an emergency becomes the joint's drive_error.
  safety::FaultSet finish(std::int64_t now_ns, Measurement& measurement) noexcept PATELLA_NONBLOCKING;
  /// Buses of the nodes that those faults are about.
  can::BusSet faultBuses() const noexcept { return fault_buses_; }
  /// Of the tick that finish() ended.
  const NodeNotices& notices() const noexcept { return notices_; }

  /// By the node's newest status word; without enable where it has not told one, or is no longer what it was
  /// set up to be.
  std::uint16_t controlword(int node, safety::DrivePhase phase,
                            safety::DriveFrames frames) const noexcept PATELLA_NONBLOCKING;

  /// What follows the commands of a tick, on each bus that has nodes: SYNC, and the heartbeat where it is
  /// due.
  std::span<const can::Frame> cycle() noexcept PATELLA_NONBLOCKING;
  /// After the last command: the drives no longer miss the loop's heartbeat, and fall silent.
  std::span<const can::Frame> farewell() const noexcept PATELLA_NONBLOCKING { return farewell_; }
  /// SYNC and heartbeat.
  const std::vector<can::Frame>& cycleFrames() const noexcept { return cycle_; }

 private:
  struct Node {
    int node = 0;
    std::uint8_t bus = 0;
    std::size_t joint = 0;
    std::uint16_t status_word = 0;
    bool has_status = false;
    bool heard = false;  ///< a heartbeat, in this tick
    bool silent = false;
    bool needs_set_up = false;
    std::uint16_t error = 0;
    std::uint8_t state = kOperationalState;
    std::int64_t heard_ns = 0;
  };
  void hearEmergency(Node& node, const can::Frame& frame) noexcept;
  void hearState(Node& node, std::uint8_t state) noexcept;
  void note(const Node& node, NoticeKind kind, std::uint16_t code, std::uint8_t error_register = 0) noexcept;

  std::vector<Node> nodes_;
  std::int64_t timeout_ns_;
  int ticks_per_heartbeat_;
  int ticks_to_heartbeat_ = 0;
  int master_node_;
  bool started_ = false;
  can::BusSet emergencies_ = 0;  ///< heard in this tick
  can::BusSet fault_buses_ = 0;
  can::BusSet buses_ = 0;          ///< with nodes on them
  std::vector<can::Frame> cycle_;  ///< SYNC of each bus, then the heartbeats
  std::vector<can::Frame> farewell_;
  NodeNotices noticed_{};  ///< since finish()
  NodeNotices notices_{};
};

/// SYNC and heartbeats, the commands and reports themselves being messages of the bus map.
void addCycleLoad(const CanopenMap& map, double rate_Hz, can::BusLoad& load, std::size_t bus = 0);

}  // namespace patella::canopen
