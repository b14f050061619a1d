// Everything that one tick measured, estimated and commanded, as the fixed-size record that leaves the loop.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/types.hpp"
#include "drivers/canopen/drive_nodes.hpp"

namespace patella::app {

/// What belongs to one joint. Quiet NaN stands for "not known in this tick" (no reference, no truth, no
/// network) and is an empty cell in the CSV.
struct JointRecord {
  double q_rad = 0.0, dq_rad_s = 0.0, drive_torque_Nm = 0.0;
  double reference_rad = 0.0, reference_rad_s = 0.0;
  double f_s_rad_s2 = 0.0, f_s_filtered_rad_s2 = 0.0, f_network_rad_s2 = 0.0, f_true_rad_s2 = 0.0,
         d_hat_Nm = 0.0;
  double torque_gravity_Nm = 0.0, torque_model_Nm = 0.0, torque_emg_Nm = 0.0, torque_impedance_Nm = 0.0;
  double torque_compensation_Nm = 0.0, torque_command_Nm = 0.0;
  double drive_temperature_degC = 0.0, drive_error = 0.0;
};

struct TickRecord {
  std::uint64_t tick = 0;
  double time_s = 0.0;       ///< scheduled instant of the tick since the start of the loop
  std::int64_t wall_ns = 0;  ///< the same instant by the wall clock, since 1970
  EmgArray emg_mV{}, activation{};
  std::uint32_t faults = 0;    ///< FaultSet of this tick
  std::uint32_t warnings = 0;  ///< safety::WarningSet
  std::uint64_t limits = 0;    ///< safety::LimitSet bits: joint 1 from bit 0, joint 2 from bit 8 and so on
  std::uint8_t state = 0;      ///< safety::State
  std::uint8_t encoder_steps = 0;      ///< sensor periods since the complete set before; 0: none is new
  std::uint32_t missed_periods = 0;    ///< skipped since the tick before
  std::int64_t wakeup_latency_ns = 0;  ///< woken later than scheduled by
  std::int64_t execution_ns = 0;       ///< from waking until the command and the lines were out
  /// Encoder frame to torque frame by their bus stamps; −1 without a new encoder frame.
  std::int64_t sensor_latency_ns = -1;
  canopen::NodeNotices notices{};  ///< what CANopen drives said of themselves
  can::BusSet fault_buses = 0;     ///< that the faults are about
  std::uint32_t joints = 0;        ///< of the mechanism
  /// The last member, so that what a record of few joints costs to hand on does not grow with kMaxJoints.
  std::array<JointRecord, kMaxJoints> joint{};
};

/// Copies all but the joints beyond the mechanism's.
void copyRecord(const TickRecord& from, TickRecord& to) noexcept PATELLA_NONBLOCKING;

/// A column of ticks.csv: header name with unit, and where the number stands.
struct TickColumn {
  std::string name;
  double (*value)(const TickRecord& record, int index);
  int index;
};

/// The columns for a mechanism of so many joints, in file order.
std::vector<TickColumn> tickColumns(int joints);

}  // namespace patella::app
