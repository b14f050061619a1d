// The part of a recorded motion that was asked for, apart from what a person's push moved.
#pragma once

#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose::evidence {

/// A push moves the joints and is answered by the controller, so that motion goes with what no model
/// explains, and a regression on it is biased. The sinusoids in the motion do not: they are instruments
/// (two-stage least squares). Puts them in place of the positions, up to `highest_Hz`.
void keepAskedMotion(Recording& recording, double highest_Hz);

/// Cuts off the ends of each stretch where the sinusoids are no account of the motion, as where a machine
/// swings in: at most a fifth at each end.
void cutToAskedMotion(Recording& recording, double highest_Hz);

}  // namespace patella::diagnose::evidence
