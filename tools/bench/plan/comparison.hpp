// A planned motion against the best single sine of the same duration and limits.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tools/bench/plan/closed_loop.hpp"
#include "tools/bench/plan/draw_machine.hpp"
#include "tools/diagnose/plan/motion_plan.hpp"

namespace patella::bench {

/// The sine has this frequency on every joint.
inline constexpr double kSine_Hz = 0.5;
struct Comparison {
  std::string machine;
  std::string effect;     ///< that is planned for: "payload@2"
  double sine = 0.0;      ///< smallest size that the sine reveals; the end of the physical range where none
  double planned = 0.0;   ///< the same of the plan
  double headroom = 1.0;  ///< Information::headroom: how many times smaller sizes any motion could reveal
  Taken taken;            ///< by the planned motion, with the effect hidden at that size
  double seconds = 0.0;   ///< of planning

  double factor() const noexcept { return sine / planned; }
  /// The factor that no motion within the limits exceeds; the plan's own where nobody would miss less.
  double possible() const noexcept { return std::isnan(headroom) ? factor() : factor() * headroom; }
};

struct CompareOptions {
  double duration_s = 20.0;
  double nominal_tolerance = 0.1;
  /// Share of each joint's torque limit with which dry friction acts, as the model says; it holds joints.
  double dry_friction = 0.0;
  int evaluations = 4000;
  std::uint64_t seed = 1;
};

/// The best sine is that of a grid over the amplitude (tenths of the largest that fits) and the phase between
/// neighbouring joints (quarters of a turn) with the lowest geometric mean of the sizes of the effects that
/// are looked at. Planned for is the one of these that even this sine shows least, by the share of the
/// joint's torque that it takes.
Comparison compare(Machine machine, const CompareOptions& options);

}  // namespace patella::bench
