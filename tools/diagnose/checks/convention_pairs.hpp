// Two wrong conventions at once, where one alone does not explain a recording.
#pragma once

#include <vector>

#include "tools/diagnose/checks/convention_score.hpp"

namespace patella::diagnose {

/// Pairs that explain the recording, `given`, together, and far better than either does alone. `alone`: every
/// convention by itself. The second ones are looked for behind the first ones that explain most, and behind
/// every sign: a sign that is wrong hides what else is. With more than two joints, both are of all joints
/// together: the number of pairs grows with the fourth power of joints. None where the model is not far off,
/// or a joint is at rest or hardly bends: many pairs explain what is left then.
std::vector<ReadAs> believedPairs(const Reader& reader, const Reading& given, const ColumnNames& names,
                                  std::vector<ReadAs> alone);

}  // namespace patella::diagnose
