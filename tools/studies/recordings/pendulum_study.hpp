// A recorded two-link arm through the loop: what its finite-time sampler says the rigid body does not
// explain, against the same quantity computed offline.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/signals/signals.hpp"
#include "tools/studies/recordings/loop_run.hpp"

namespace patella::study {

using offline::Samples;

/// d = I ddq + C dq + K − tau of one joint, N·m: of the loop as it came, and of the inverse dynamics offline,
/// both −3 dB at the loop's estimate cutoff (the offline filter is twice as steep beyond). The ends, where
/// filters settle, are left out.
struct JointComparison {
  Samples loop_Nm;
  Samples offline_Nm;
  Samples aligned_Nm;  ///< of the loop, its delay taken out
  Samples rate_rad_s;  ///< offline
  double correlation_delayed = 0.0;
  double correlation_aligned = 0.0;
  double rms_loop_Nm = 0.0;
  double rms_offline_Nm = 0.0;
  double rms_difference_delayed_Nm = 0.0;
  double rms_difference_aligned_Nm = 0.0;
  double measured_delay_s = 0.0;  ///< lag of the largest correlation
  double friction_loop_Nm = 0.0;  ///< mean of −d sign(dq) where the joint moves: Coulomb, and what adds to it
  double friction_offline_Nm = 0.0;
};

struct PendulumStudy {
  std::string run;
  double rate_Hz = 500.0;
  double delay_s = 0.0;  ///< of the causal chain at low frequency, from its filters
  Samples time_s;
  std::array<JointComparison, 2> joint;
};

/// Runs the loop and compares. Throws as runRecording().
PendulumStudy studyPendulum(const Folders& folders, const std::string& run);

const std::vector<std::string>& recordedPendulumRuns();

}  // namespace patella::study
