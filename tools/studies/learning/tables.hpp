// Results as text.
#pragma once

#include <span>
#include <string>

#include "tools/studies/learning/leg_study.hpp"

namespace patella::study {

/// One result, for who waits.
std::string line(const LegResult& result);

/// In Markdown: means over seeds with 95 % confidence intervals (Student's t), and the ratio of each seed's
/// error, summed over joints, to that of the first estimator of its condition and horizon, each and their
/// mean.
std::string table(std::span<const LegResult> results);

/// Half the width of the 95 % interval of a mean; 0 of a single value.
double halfInterval(std::span<const double> values);
double meanOf(std::span<const double> values);

}  // namespace patella::study
