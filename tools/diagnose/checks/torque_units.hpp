// Whether a torque is in N·m, told from its size where friction leaves too much of it unexplained for a
// reading in another unit to stand out.
#pragma once

#include "firmware_app/files/model_file.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Throws std::invalid_argument, naming column, what is seen and what is needed, where a torque goes with the
/// model's, but is so many times as large as only another unit makes it. A torque that does not go with the
/// model's, as that of a drive without current, tells nothing of its unit.
void requireTorqueUnits(const Recording& recording, const app::ModelDescription& model);

}  // namespace patella::diagnose
