// How late a drive acts, told from the fast part of recordings: where friction reverses within milliseconds,
// a delay shows that the slow motion, in which effects are told apart, hardly knows.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// A delay or a lag of one drive.
struct LateDrive {
  model::EffectDescription effect;
  ParameterEstimate estimate;
  Evidence evidence;
};

/// Why it is not asserted then.
inline constexpr const char* kMayBeTimingWords =
    "so short a delay may come of when, within a sample, a row was read";

/// Torque that is late by less may as well have been read so: when within a period the columns of a row were
/// taken is hardly ever known. Half a period; more where the motion, and nobody who knows, told that a torque
/// was not held.
double leastLateness_s(std::span<const Recording> recordings);

/// Delays and lags of the drives of `joints` that show beside what `explained` has, through every gate of a
/// selection, on joints whose torque `explained` leaves little of. Friction and all else that `explained` has
/// may move within what a fit allows declared effects. What `resting` joints do at rest does not count.
std::vector<LateDrive> findLateDrives(std::span<const Recording> recordings,
                                      const model::ModelDescription& explained, std::span<const int> joints,
                                      std::span<const RestingJoint> resting, const FitOptions& fit,
                                      const SelectionOptions& selection);

}  // namespace patella::diagnose
