// The verdict as one function of what an inference found out.
#pragma once

#include <span>

#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose::evidence {

struct Found {
  bool effects = false;    ///< one of the library explains what was missing
  bool functions = false;  ///< so does a function of motion or time without a name
  bool runaway = false;    ///< the given parameters have to leave their tolerance
};

/// Share of a joint's torque that may be left beyond noise: of what is said to lack nothing, or to lack what
/// was found.
double allowedRest(const Found& found) noexcept;

/// In this order: something that has no name, effects, a rest that is too large for "nothing", nothing.
Verdict verdictOf(const Found& found, std::span<const JointRest> joints) noexcept;

}  // namespace patella::diagnose::evidence
