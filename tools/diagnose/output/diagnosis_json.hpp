// A diagnosis for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Everything but the curves, in the order of the file: verdict, explanation, effects, error,
/// simulation_error, excitation, unexplained, nominal_parameters, correlations, runaways, drive_timing,
/// steps, warnings, seed, inputs, versions. Joints count from 1; what is not a number is null in the text.
nlohmann::ordered_json diagnosisJson(const Diagnosis& diagnosis);

/// Its text. What is not UTF-8 in paths and names is replaced.
std::string diagnosisText(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
