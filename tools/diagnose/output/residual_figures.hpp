// The residual of a diagnosis, drawn.
#pragma once

#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/report/figure.hpp"

namespace patella::diagnose {

/// Residuals before and after: against the variable in which each effect found shows (or what the rest
/// depends on, or else velocity), their spectra and autocorrelations. Postures at rest have no spectra.
std::vector<report::Figure> residualFigures(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
