// A diagnosis for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Everything but the curves, from the verdict to the versions of the libraries. Joints count from 1; what is
/// not a number is null in the text.
nlohmann::ordered_json diagnosisJson(const Diagnosis& diagnosis);

/// Its text. What is not UTF-8 in paths and names is replaced.
std::string diagnosisText(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
