// From terms of a fit to findings with names: what a search found, as a diagnosis tells it.
#pragma once

#include <span>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/missing_effects.hpp"

namespace patella::diagnose {

/// Writes effects with their parameters, tremors whose phase wanders, the steps of the search, refitted
/// parameters and their correlations into the diagnosis. `noise_Nm`: what sensors and declared pushes make of
/// each joint; `dependences`: what the rest behind the found
/// effects depends on. A doubt is added where it, or what was found itself, bends like no effect of the
/// library.
void nameEffects(const AnalysedRecordings& recordings, MissingEffects& found,
                 const std::vector<Dependence>& dependences, std::span<const double> noise_Nm,
                 const DiagnoseOptions& options, Diagnosis& diagnosis);

}  // namespace patella::diagnose
