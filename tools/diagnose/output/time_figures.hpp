// Figures over time: torque, motion and residual.
#pragma once

#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/report/figure.hpp"
#include "tools/report/palette.hpp"

namespace patella::diagnose {

/// Colours of the two models that every picture compares.
namespace colour {
inline constexpr const char* kBefore = report::colour::kRed;
inline constexpr const char* kAfter = report::colour::kBlue;
}  // namespace colour

/// For each joint the measured torque against that of the model as given and with what was found, and the
/// residual of both; then measured against simulated motion. Postures at rest have no figures.
std::vector<report::Figure> timeFigures(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
