// Options of the loop.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware_app/loop/lateness.hpp"

namespace patella::app {

struct LoopOptions : LatenessLimits {
  std::uint64_t max_ticks = 0;      ///< 0: until stopped or the backend is exhausted
  int send_failures_tolerated = 3;  ///< commands that may be lost in a row, or among others, before a fault
  double clock_step_s = 0.05;       ///< change of wall time against the loop's clock that is told of
  std::size_t buses = 1;            ///< that frames come from
  int shutdown_frames = 10;         ///< zero-torque, drives-disabled frames sent when the loop ends
};

}  // namespace patella::app
