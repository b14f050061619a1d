#include "drivers/canopen/drive_nodes.hpp"

#include <algorithm>
#include <cmath>

#include "core/safety/cia402_state.hpp"
#include "drivers/canopen/network_frames.hpp"

namespace patella::canopen {

using safety::DriveFrames;
using safety::DrivePhase;

DriveNodes::DriveNodes(const CanopenMap& map, double period_s)
    : timeout_ns_(std::llround(1e9 * map.network.node_heartbeat_timeout_s)),
      ticks_per_heartbeat_(
          std::max(static_cast<int>(std::floor(map.network.heartbeat_period_s / period_s + 1e-6)), 1)),
      master_node_(map.network.master_node) {
  const auto on = [](std::size_t bus, can::Frame frame) {
    frame.bus = static_cast<std::uint8_t>(bus);
    return frame;
  };
  for (const DriveSettings& drive : map.drives) {
    nodes_.push_back({.node = drive.node, .bus = drive.bus, .joint = static_cast<std::size_t>(drive.joint)});
    buses_ = static_cast<can::BusSet>(buses_ | can::busBit(drive.bus));
    farewell_.push_back(on(drive.bus, downloadFrame(drive.node, {0x1016, 1, 4, 0})));
    farewell_.push_back(on(drive.bus, nmtFrame(NmtCommand::kPreOperational, drive.node)));
  }
  for (const can::Frame& frame : {syncFrame(), heartbeatFrame(master_node_)}) {
    for (std::size_t bus = 0; bus < can::kMaxBuses; ++bus) {
      if ((buses_ & can::busBit(bus)) != 0) {
        cycle_.push_back(on(bus, frame));
      }
    }
  }
}

void DriveNodes::accept(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  if (!isStandard(frame)) {
    return;
  }
  for (Node& node : nodes_) {
    if (frame.bus != node.bus) {
      continue;
    }
    if (frame.id == reportId(node.node) && frame.length >= 2) {
      node.status_word = static_cast<std::uint16_t>(readLittleEndian(frame, 0, 2));
      node.has_status = true;
    } else if (frame.id == heartbeatId(node.node) && frame.length >= 1) {
      hearState(node, frame.data[0]);
    } else if (frame.id == emergencyId(node.node) && frame.length >= 3) {
      hearEmergency(node, frame);
    }
  }
}

void DriveNodes::hearState(Node& node, std::uint8_t state) noexcept {
  node.heard = true;
  if (state != kOperationalState && state != node.state) {
    note(node, state == kBootUpState ? NoticeKind::kBootUp : NoticeKind::kState, state);
  }
  node.state = state;
  node.needs_set_up = node.needs_set_up || state != kOperationalState;
}

void DriveNodes::hearEmergency(Node& node, const can::Frame& frame) noexcept {
  constexpr std::uint16_t kClass = 0xFF00;
  const auto code = static_cast<std::uint16_t>(readLittleEndian(frame, 0, 2));
  node.error = code;
  if ((code & kClass) == 0) {
    node.error = 0;  // an error that has gone
    return;
  }
  emergencies_ = static_cast<can::BusSet>(emergencies_ | can::busBit(node.bus));
  note(node, NoticeKind::kEmergency, code, frame.data[2]);
}

// The first of a tick is the cause, what follows its consequence.
void DriveNodes::note(const Node& node, NoticeKind kind, std::uint16_t code,
                      std::uint8_t error_register) noexcept {
  NodeNotice& notice = noticed_[node.joint];
  if (notice.kind == NoticeKind::kNone) {
    notice = {kind, static_cast<std::uint8_t>(node.node), error_register, code};
  }
}

bool DriveNodes::reserved(const can::Frame& frame) const noexcept PATELLA_NONBLOCKING {
  if ((buses_ & can::busBit(frame.bus)) == 0 || !isStandard(frame)) {
    return false;
  }
  const bool request = std::any_of(nodes_.begin(), nodes_.end(), [&frame](const Node& node) {
    return frame.bus == node.bus && frame.id == sdoRequestId(node.node);
  });
  return request || frame.id == kNmtId || frame.id == kSyncId || frame.id == heartbeatId(master_node_);
}

safety::FaultSet DriveNodes::finish(std::int64_t now_ns,
                                    Measurement& measurement) noexcept PATELLA_NONBLOCKING {
  safety::FaultSet faults;
  fault_buses_ = emergencies_;
  for (Node& node : nodes_) {
    if (node.heard || !started_) {
      node.heard_ns = now_ns;
    }
    node.heard = false;
    const bool silent = now_ns - node.heard_ns > timeout_ns_;
    if (silent && !node.silent) {
      note(node, NoticeKind::kSilent, 0);
    }
    node.silent = silent;
    if (silent || node.needs_set_up) {
      faults.add(safety::Fault::kDriveOffline);
      fault_buses_ = static_cast<can::BusSet>(fault_buses_ | can::busBit(node.bus));
    }
    measurement.drive_error[node.joint] = node.error;
  }
  if (emergencies_ != 0) {
    faults.add(safety::Fault::kDriveEmergency);
  }
  emergencies_ = 0;
  started_ = true;
  notices_ = noticed_;
  noticed_ = {};
  return faults;
}

std::uint16_t DriveNodes::controlword(int node, DrivePhase phase,
                                      DriveFrames frames) const noexcept PATELLA_NONBLOCKING {
  const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                  [node](const Node& candidate) { return candidate.node == node; });
  if (found == nodes_.end() || !found->has_status || found->needs_set_up) {
    return 0;
  }
  const bool enable = phase == DrivePhase::kEntering || phase == DrivePhase::kIn;
  return safety::cia402Controlword(safety::cia402State(found->status_word), enable,
                                   frames == DriveFrames::kClear);
}

std::span<const can::Frame> DriveNodes::cycle() noexcept PATELLA_NONBLOCKING {
  if (!any()) {
    return {};
  }
  const bool due = ticks_to_heartbeat_ == 0;
  ticks_to_heartbeat_ = due ? ticks_per_heartbeat_ - 1 : ticks_to_heartbeat_ - 1;
  return std::span<const can::Frame>(cycle_).first(due ? cycle_.size() : cycle_.size() / 2);
}

void addCycleLoad(const CanopenMap& map, double rate_Hz, can::BusLoad& load, std::size_t bus) {
  const auto add = [&load](int bytes, double frames_per_s) {
    load.frames_per_s += frames_per_s;
    load.bits_per_s += frames_per_s * can::mostBits(bytes, false, false);
  };
  const auto nodes = std::count_if(map.drives.begin(), map.drives.end(),
                                   [bus](const DriveSettings& drive) { return drive.bus == bus; });
  if (nodes == 0) {
    return;
  }
  add(0, rate_Hz);
  add(1, 1.0 / map.network.heartbeat_period_s);
  add(1, static_cast<double>(nodes) / map.network.node_heartbeat_period_s);
}

}  // namespace patella::canopen
