// Options of the watchdog.
#pragma once

namespace patella::app {

struct WatchdogOptions {
  double timeout_s = 0.05;     ///< without a tick before the line goes down
  int priority = 0;            ///< SCHED_FIFO of the thread, above the loop's; 0 leaves the scheduling alone
  double loop_period_s = 0.0;  ///< where known, the thread wakes midway between two ticks, out of their way
};

}  // namespace patella::app
