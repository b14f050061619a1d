// Figures of the sizes that a recording would have revealed.
#pragma once

#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/report/figure.hpp"

namespace patella::diagnose {

/// One picture for each joint: the smallest torque of every effect that was looked for and not found.
std::vector<report::Figure> powerFigures(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
