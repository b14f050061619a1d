// How the joints moved, and what such a motion can and cannot tell.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {

/// Excitation of a joint by its signals alone, over all recordings.
struct JointSignals {
  double position_range_rad = 0.0;  ///< below 10 Hz
  double velocity_rms_rad_s = 0.0;  ///< below 10 Hz
  /// False where range or velocity are no more than those of an encoder at rest, or next to nothing against
  /// those of the other joint.
  bool moves = false;
  bool constant_torque = false;
  double clipped_share =
      0.0;  ///< of the rows of a recording, where torque sits at its largest or smallest value
  double clipped_Nm = 0.0;
  double line_share = 0.0;  ///< of the velocity's power that one sinusoid holds
  double line_Hz = 0.0;
};
std::vector<JointSignals> jointSignals(std::span<const Recording> recordings);

/// Why these recordings tell nothing, whatever effects are considered: no joint moves, a torque that does not
/// change though no passive machine moves so, torque that is cut off in more than 5 % of the rows. Empty
/// where they may.
std::string obstacle(std::span<const JointSignals> signals, const Dataset& data,
                     const model::ModelDescription& model);

/// Signs of the motion alone: range and velocity, joints at rest, single sinusoids, torque that is now and
/// then cut off; the latter three also as warnings.
void describeMotion(std::span<const JointSignals> signals, Diagnosis& diagnosis);

/// Fills in what a diagnosis could have found: effects that would stand out from chance if their torque were
/// as large as the noise (rms), and nominal parameters that the recordings narrowed. Adds a doubt where an
/// answer would rest on more than the motion tells: a joint does not move; most of the plainest effects would
/// not show at three times the noise; next to nothing that acts on one of
/// the joints would show; two or more effects were found under single sinusoids; torque and
/// encoder of a joint at rest contradict each other.
void judgeExcitation(std::span<const JointSignals> signals, const Dataset& data, const ModelFit& fit,
                     const Atoms& atoms, Diagnosis& diagnosis);

}  // namespace patella::diagnose
