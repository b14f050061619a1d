// A diagnosis with something in every place, as the decision procedure could have made it.
#pragma once

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::test {

/// Two joints, two recordings with a held-out end each; joint 2 rubs with 1.5 N·m and is held by a spring.
diagnose::Diagnosis madeUpDiagnosis();
/// Postures of one joint, without any order in time.
diagnose::Diagnosis madeUpPostures();

}  // namespace patella::test
