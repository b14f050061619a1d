// A diagnosis for people.
#pragma once

#include <string>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// One HTML page that needs nothing beside it: the verdict, what was found and how sure it is, the errors
/// before and after, every picture. Throws std::runtime_error where gnuplot is missing or fails.
std::string diagnosisPage(const Diagnosis& diagnosis);

}  // namespace patella::diagnose
