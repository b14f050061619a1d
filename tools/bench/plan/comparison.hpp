// A planned motion against the best single sine of the same duration and limits.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/plan/closed_loop.hpp"
#include "tools/bench/plan/draw_machine.hpp"
#include "tools/diagnose/plan/motion_plan.hpp"

namespace patella::bench {

/// The sine has this frequency on every joint.
inline constexpr double kSine_Hz = 0.5;
/// Effects that are planned for: those that the sine shows least.
inline constexpr std::size_t kNamed = 2;

struct Compared {
  std::string label;  ///< "payload@2"
  double sine = 0.0;  ///< smallest size that it reveals; the end of the physical range where none
  double planned = 0.0;
  bool sine_never = false;
  double factor() const noexcept { return sine / planned; }
};

struct Comparison {
  std::string machine;
  std::vector<Compared> named;
  double factor = 0.0;   ///< geometric mean over the named effects
  Taken taken;           ///< by the planned motion, the hidden effects at twice their smallest sizes
  double seconds = 0.0;  ///< of planning
};

struct CompareOptions {
  double duration_s = 20.0;
  int evaluations = 4000;
  std::uint64_t seed = 1;
};

/// The best sine is that of a grid over the amplitude (tenths of the largest that fits) and the phase between
/// neighbouring joints (quarters of a turn) with the lowest geometric mean of the sizes of the effects that
/// are looked at. Of these, the ones that even this sine shows least are planned for.
Comparison compare(const Machine& machine, const CompareOptions& options);

}  // namespace patella::bench
