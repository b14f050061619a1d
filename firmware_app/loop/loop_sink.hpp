// The one place that the loop tells what it did. The loop acts; whoever counts, records or shows is behind
// this.
#pragma once

#include <cstdint>
#include <optional>

#include "core/measurement.hpp"
#include "core/safety/warning.hpp"
#include "core/tick/tick.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/canopen/drive_nodes.hpp"

namespace patella::app {

/// Measurement, results and command of one tick. The references hold during the call alone.
struct TickReport {
  std::uint64_t tick = 0;              ///< periods since the start of the loop, the skipped ones included
  double time_s = 0.0;                 ///< scheduled instant since the start of the loop
  std::int64_t wall_ns = 0;            ///< the same instant, as the wall clock stood when the run began
  std::uint32_t missed_periods = 0;    ///< skipped since the tick before
  std::int64_t wakeup_latency_ns = 0;  ///< woken later than scheduled by
  std::int64_t execution_ns = 0;       ///< from waking until the command and the lines were out
  /// Encoder frame to torque frame by their bus stamps; none where either was missing.
  std::optional<std::int64_t> sensor_latency_ns;
  safety::WarningSet warnings;
  const Measurement& measurement;
  const tick::TickOutput& output;
  const Command& sent;             ///< differs from the output's where that came too late
  canopen::NodeNotices notices{};  ///< what CANopen drives said of themselves
  can::BusSet fault_buses = 0;     ///< on which frames are missing, damaged or lost, as the faults say
};

/// All calls come from the loop's thread.
class LoopSink {
 public:
  virtual ~LoopSink() = default;

  /// Before the first tick, and after the last. The frames that end a run follow.
  virtual void begin() noexcept = 0;
  virtual void end() noexcept = 0;

  /// A frame that came in, or that was sent.
  virtual void frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING = 0;
  /// A tick whose command is out; what the next one can have ready is still to be computed.
  virtual void tick(const TickReport& report) noexcept PATELLA_NONBLOCKING = 0;
  /// A tick is over. `overrun`: after the next one was due; `missed`: whole periods to be skipped for it.
  virtual void tickEnded(bool overrun, std::uint32_t missed) noexcept = 0;
};

}  // namespace patella::app
