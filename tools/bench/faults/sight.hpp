// A fault as the loop can see it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/fault_script.hpp"
#include "tools/bench/faults/scenario.hpp"

namespace patella::bench {

/// `faults[index]` sample by sample from its effect on, which was at `effect_s`. Keeps a reference to
/// `faults`.
class Sight {
 public:
  Sight(const std::vector<sim::FaultEvent>& faults, std::size_t index, double effect_s)
      : faults_(faults), event_(faults[index]), effect_s_(effect_s) {}

  /// Calls judge(t, there, heard) for each sample: whether the fault is there, and whether the sample comes
  /// through at all. What takes samples by chance takes those that show the fault, as many as it can be
  /// expected to. Returns the first t for which it says true.
  template <typename Judge>
  std::optional<double> walk(double period_s, Judge&& judge) const {
    const auto first = static_cast<std::int64_t>(std::ceil(effect_s_ / period_s - 1e-6));
    int shown = 0;
    int taken = 0;
    for (std::int64_t k = first; static_cast<double>(k) * period_s < kTrialDuration_s; ++k) {
      const double t = static_cast<double>(k) * period_s;
      const bool there = event_.activeAt(t);
      const double probability = hidingProbability(t);
      bool heard = probability < 1.0;
      if (heard && there && probability > 0.0 && taken < mostTaken(++shown, probability)) {
        ++taken;
        heard = false;
      }
      if (judge(t, there, heard)) {
        return t;
      }
    }
    return std::nullopt;
  }
  const sim::FaultEvent& event() const { return event_; }

 private:
  static int mostTaken(int samples, double probability);
  double hidingProbability(double t) const;
  bool hides(const sim::FaultEvent& other) const;

  const std::vector<sim::FaultEvent>& faults_;
  const sim::FaultEvent& event_;
  double effect_s_;
};

}  // namespace patella::bench
