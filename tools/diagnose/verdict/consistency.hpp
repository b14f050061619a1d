// Whether recordings that were diagnosed together agree: an effect that is there in one run and not in the
// next is a mean of two truths, and neither.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Runs that contradict each other have no common answer: adds what differs to the warnings, to what is not
/// explained (the variable "recording"), and a doubt. Two questions to a fit's linearisation, the joints'
/// noise taken as the fit has it. Do the found effects' strengths, fitted to each recording alone, differ by
/// more than half with disjoint 99.9 % intervals? Does the error fall by more than 30 % where nominal
/// parameters, friction, stiffness and bias may differ between recordings (Chow 1960, Econometrica 28(3),
/// here by chi-squared over the noise's redundancy, p < 0.001)? `names` are those of the recordings in the
/// order of Block::recording.
void judgeConsistency(const Dataset& data, const ModelFit& fit, std::span<const std::string> names,
                      Diagnosis& diagnosis);

}  // namespace patella::diagnose
