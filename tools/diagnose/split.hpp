// A part to fit and a part to judge by.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/recording.hpp"

namespace patella::diagnose {

/// The same recordings cut in two: all but the last `fraction` of each stretch, and that. A stretch whose
/// parts would be too short stays whole in the first. Of postures at rest every few are held out.
struct SplitRecordings {
  std::vector<Recording> train;
  std::vector<Recording> heldout;
};
SplitRecordings split(std::span<const Recording> recordings, double heldout_fraction);

}  // namespace patella::diagnose
