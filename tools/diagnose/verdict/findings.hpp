// Statements of a diagnosis about its effects beyond their parameters, and about itself.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// Text after "possibly: " for an effect that is not asserted.
inline constexpr const char* kOutweighedWords = "what stays unexplained is as large";
/// Likewise, where nothing stays unexplained.
inline constexpr const char* kTakenUpWords = "the model's own parameters could take its place";
inline constexpr const char* kMayBeOfCauseWords =
    "it explains no more than the cause may leave that all joints share";

/// An effect with its parameters and how it was found. What it cannot be told from: its rivals, and what
/// equals it by algebra, whatever the motion, or is the limit of what could be behind it; and the motion that
/// would tell them apart. Intervals come out wider, by an allowance for the shape of the effect. `replaces`:
/// kinds of the model's effects in whose place it stands.
EffectFinding findingOf(const std::string& kind, int joint, std::vector<ParameterEstimate> parameters,
                        const Evidence& evidence, int joints, std::vector<std::string> replaces = {});

/// The same of a found term, with its estimates by the covariance.
EffectFinding findingOf(const ModelFit& fit, const Eigen::MatrixXd& covariance, std::size_t term,
                        const Evidence& evidence, int joints);

/// Adds what cannot be told apart because of what was found together: a spring that rests elsewhere takes up
/// what two levels of friction differ by.
void addConfoundsBetween(std::vector<EffectFinding>& findings);

/// Parameters that the fit took out of what is known of them, in a sentence; empty where there is none.
std::string beyondTolerance(const Diagnosis& diagnosis);
/// What those within their tolerances explain of the error of the joint where that is most; empty where none
/// loses more than runaway::kTookUp leaves, or where some parameter is beyond.
std::string takenUpWithinTolerance(const Diagnosis& diagnosis);

/// The verdict in a sentence or two. Nominal parameters count as moved where they left their tolerance.
std::string explanation(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
