// A loop to be measured: the shipped one, with more or less to do.
#pragma once

#include <filesystem>
#include <string>

#include "firmware_app/recorder/loop_statistics.hpp"
#include "tools/bench/tick/stage_meter.hpp"

namespace patella::bench {

struct Workload {
  std::string name;
  double rate_Hz = 1000.0;
  bool network = true;
  int window = 64;         ///< of the network, steps
  bool kalman = true;      ///< a Kalman observer beside the sampler
  int effects = 5;         ///< in the loop's model
  int foreign_frames = 0;  ///< a tick, beside the rig's
  double seconds = 4.0;
};

struct Pace {
  bool real_time = false;  ///< ticks when the clock says so, rather than one after the other
  std::string interface;   ///< with real_time: a CAN interface at which a rig is; empty: one in this thread
  int priority = 80;
};

/// Runs the loop with the configuration and the recorder of `patella run`, the recording in a folder that is
/// removed again. Returns what the loop counted. Throws what loading the configuration, CAN or the real-time
/// set-up throw.
app::LoopStatistics runWorkload(const std::filesystem::path& config, const Workload& workload,
                                const Pace& pace, StageMeter& meter);

}  // namespace patella::bench
