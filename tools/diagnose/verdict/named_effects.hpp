// From terms of a fit to findings with names: what a search found, as a diagnosis tells it.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/missing_effects.hpp"

namespace patella::diagnose {

/// Writes effects with their parameters, tremors whose phase wanders, the steps of the search, refitted
/// parameters and their correlations into the diagnosis. `left`: what the found effects leave, with `rests`
/// by joint; `dependences`: what it depends on. A doubt is added where it, or what was found itself, bends
/// like no effect of the library.
void nameEffects(const AnalysedRecordings& recordings, MissingEffects& found, const Column& left,
                 std::span<const JointRest> rests, const std::vector<Dependence>& dependences,
                 const DiagnoseOptions& options, Diagnosis& diagnosis);

}  // namespace patella::diagnose
