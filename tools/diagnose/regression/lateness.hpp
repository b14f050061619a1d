// What a drive that acts late leaves of a model's error.
#pragma once

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Of each joint's measured torque, N·m/s: what a delay of one second would make of it, as far as it is
/// small.
Column torqueRate(const Dataset& data);

/// Change a second of a torque that goes through the band, joint by joint and block by block.
Column rateOf(const Dataset& data, const Column& torque);

/// `error`, measured torque less the model's, without what each joint's drive makes of it by acting late: its
/// part along the rate of the measured torque, where that has the sign of a late drive.
Column besideLateness(const Dataset& data, const Column& error);

}  // namespace patella::diagnose
