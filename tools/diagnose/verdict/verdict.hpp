// The verdict as one function of what the stages of a diagnosis found.
#pragma once

#include <span>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// The doubt that decides, which is the first that counts against such an answer, in the order of `Doubt`;
/// null where none does. `effects`: some of the library were found that outweigh the rest.
const Doubt* decidingDoubt(std::span<const Doubt> doubts, bool effects) noexcept;

/// The verdict by the deciding doubt; without one effects are found, or nothing is missing.
Verdict verdictOf(std::span<const Doubt> doubts, bool effects) noexcept;

/// Writes verdict and explanation into a diagnosis whose effects and doubts are complete.
void settle(Diagnosis& diagnosis);

}  // namespace patella::diagnose
