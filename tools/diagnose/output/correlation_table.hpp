// Correlations of the fitted parameters, for people.
#pragma once

#include <string>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/result/parameter_text.hpp"

namespace patella::diagnose {

/// Correlations above this, either sign, are said in words.
inline constexpr double kStrongCorrelation = 0.9;

/// One sentence for each pair that is strongly correlated, strongest first.
std::vector<std::string> strongCorrelations(const Correlations& correlations, const Units& units);

/// The sentences and the matrix, whose cells are coloured by the correlation, as HTML; empty where fewer than
/// two parameters were fitted.
std::string correlationTable(const Correlations& correlations, const Units& units);

}  // namespace patella::diagnose
