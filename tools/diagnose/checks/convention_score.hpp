// How much better a recording is explained in one convention than as given: what decides which is named.
#pragma once

#include <vector>

#include "tools/diagnose/checks/reading.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

struct ReadAs {
  Convention convention;
  Reading reading;
};

/// How much less is left, as a logarithm, all joints together.
double gain(const std::vector<double>& given, const std::vector<double>& read,
            double floor = convention::kFloor);

/// The same of what the recording as given leaves; least of all where a torque is scaled and not explained
/// itself.
double gainOf(const ReadAs& one, const Reading& given);

/// The least that two conventions at once gain on one alone, as a logarithm: each is worth it by itself.
double leastGainOfPair();

bool leavesAsMachines(const Reading& reading);

/// Whether no more is left than of the best one, so that both are named.
bool asGood(const ReadAs& one, const ReadAs& best);

/// Whether it explains the recording far better than it is explained as given, and about as well as effects
/// explain it, and some joint speaks for it.
bool isBelieved(const ReadAs& one, const Reading& given);

}  // namespace patella::diagnose
