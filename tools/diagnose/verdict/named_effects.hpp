// From terms of a fit to findings with names: what a search found, as a diagnosis tells it.
#pragma once

#include <span>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/missing_effects.hpp"
#include "tools/diagnose/verdict/unexplained_rest.hpp"

namespace patella::diagnose {

/// Writes effects with their parameters, tremors whose phase wanders, the steps of the search, refitted
/// parameters and their correlations into the diagnosis. `rest`: what the found effects leave. A doubt is
/// added where it, or what was found itself, bends like no effect of the library. `cause_Nm`: torque (rms) on
/// each joint of a shared cause that was taken out of the recordings; empty where none was.
void nameEffects(const AnalysedRecordings& recordings, MissingEffects& found, const UnexplainedRest& rest,
                 const DiagnoseOptions& options, std::span<const double> cause_Nm, Diagnosis& diagnosis);

}  // namespace patella::diagnose
