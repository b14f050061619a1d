// Position and rate of one encoder must tell of the same motion.
#pragma once

#include <array>

#include "core/safety/monitor_settings.hpp"
#include "core/types.hpp"

namespace patella::safety {

/// r_k = e^{−dt/T} r_{k−1} + (q_k − q_{k−1}) − ½ dt (dq_k + dq_{k−1}): zero for consistent sensors, whatever
/// the motion; a jump appears in full, a drift v as v T, a frozen position as the way gone meanwhile.
class EncoderMonitor {
 public:
  /// Longest step that is followed; after it both start anew.
  static constexpr double kMaxStep_s = 0.02;
  /// Samples of one value after which a position is held to frozen_rad.
  static constexpr int kStillSamples = 20;

  EncoderMonitor(int joints, const EncoderMonitorSettings& settings) noexcept
      : settings_(settings), q_(JointVector::Zero(joints)), dq_(q_), residual_rad_(q_) {}

  /// Takes a new sample, `dt_s` after the one before. True where a joint is inconsistent.
  bool update(const JointVector& q, const JointVector& dq, double dt_s) noexcept PATELLA_NONBLOCKING;
  void reset() noexcept { started_ = false; }
  const JointVector& residual_rad() const noexcept { return residual_rad_; }

 private:
  EncoderMonitorSettings settings_;
  JointVector q_, dq_, residual_rad_;
  std::array<int, kMaxJoints> still_{};
  bool started_ = false;
};

}  // namespace patella::safety
