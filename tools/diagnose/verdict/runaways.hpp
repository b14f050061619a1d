// Numbers of a diagnosis that a reader has to look at twice.
#pragma once

#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Text after "possibly: " for an effect that is not asserted.
inline constexpr const char* kUnknownStrengthWords = "how large it is the recording does not tell";

/// Whether nothing that the effect's torque grows with is known: it stands at an end of its range, or its
/// interval holds zero or the whole range. No answer rests on such an effect.
bool strengthIsUnknown(const EffectFinding& effect);

/// Text after "possibly: ", likewise.
inline constexpr const char* kUnknownPeriodsWords =
    "how many periods it has over the joint's range the recording does not tell";

/// Whether a ripple may have half a period more over the joint's range (rad or m), or less: it bends as it
/// likes then. False of every other effect.
bool periodsAreUnknown(const EffectFinding& effect, double joint_range);

/// Text after "possibly: ", likewise.
inline constexpr const char* kMayBeAnotherWords =
    "what distinguishes it from other effects of the same variable stands where the search ends";

/// Whether the parameter that tells the effect from plainer ones (EffectHome::distinguished_by) is at an end
/// of the search.
bool mayBeAnother(const EffectFinding& effect);

/// In this order: errors that are larger than the torque, parameters of effects that were found at a bound
/// of their range or with an interval that holds zero or the whole range, mechanism parameters beyond their
/// tolerance, and declared effects of `given` that changed beyond theirs or vanished. Tolerances are standard
/// deviations, relative.
std::vector<Runaway> runawaysOf(const Diagnosis& diagnosis, const model::ModelDescription& given,
                                const FitOptions& tolerances);

}  // namespace patella::diagnose
