// Statistics of a run of the loop.
#pragma once

#include <array>
#include <cstdint>

#include "core/safety/fault.hpp"
#include "core/safety/state_machine.hpp"
#include "core/safety/warning.hpp"
#include "core/types.hpp"
#include "firmware_app/recorder/latency_histogram.hpp"
#include "firmware_app/recorder/tick_record.hpp"

namespace patella::app {

/// Mean, RMS and maximum of |estimate − f_u| where the rig tells the truth.
struct ErrorStatistics {
  std::uint64_t count = 0;
  PerJoint sum{}, sum_of_squares{}, maximum{};
  void add(const JointVector& estimate, const JointVector& truth) noexcept PATELLA_NONBLOCKING;
};

struct LoopStatistics {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;        ///< ticks that ended after the next one was due
  std::uint64_t missed_periods = 0;  ///< whole periods skipped because of them
  LatencyHistogram wakeup, execution;
  LatencyHistogram sensor_to_torque;                   ///< from the end of init on
  std::uint64_t heap_allocations = 0, heap_frees = 0;  ///< by the loop thread after warm-up
  bool heap_counted = false;                           ///< false in sanitizer builds
  std::uint64_t minor_page_faults = 0, major_page_faults = 0;
  std::uint64_t voluntary_switches = 0, involuntary_switches = 0;
  std::array<std::uint64_t, safety::kFaultCount> fault_ticks{};   ///< ticks in which each cause was present
  std::array<std::uint64_t, safety::kFaultCount> fault_events{};  ///< times each cause appeared
  std::array<std::uint64_t, can::kMaxBuses> bus_fault_ticks{};    ///< ticks in which a fault was about a bus
  std::array<std::uint64_t, safety::kWarningCount> warning_ticks{};
  std::uint64_t limit_ticks = 0;  ///< ticks in which a limit held the command back
  std::uint64_t stops = 0;        ///< entries into limited or fault
  std::array<std::uint64_t, safety::kStateCount> state_ticks{};
  safety::State final_state = safety::State::kInit;
  safety::FaultSet latched;
  double max_torque_Nm = 0.0;
  ErrorStatistics sampler_error;   ///< of the observer as it comes
  ErrorStatistics filtered_error;  ///< of the same behind its low-pass, which is what compensates
  ErrorStatistics network_error;
  PerJoint tracking_sum_of_squares{};  ///< rad², while active and a reference exists
  PerJoint f_s_sum_of_squares{};       ///< (rad/s²)², of the filtered estimate while active
  PerJoint d_hat_sum_of_squares{};     ///< (N·m)², likewise
  std::uint64_t tracking_count = 0;
};

}  // namespace patella::app
