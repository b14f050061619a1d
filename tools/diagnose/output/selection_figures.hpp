// How a diagnosis came to its effects, and how well it knows them, drawn.
#pragma once

#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/report/figure.hpp"

namespace patella::diagnose {

/// One ranking of candidates for each step, and the parameters found with their intervals.
std::vector<report::Figure> selectionFigures(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
