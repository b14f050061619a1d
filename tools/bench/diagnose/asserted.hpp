// The effects that a diagnosis asserts; the benchmark marks these.
#pragma once

#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::bench {

/// Takes away findings that may be a part of something else: they are neither right nor false.
inline void keepAsserted(diagnose::Diagnosis& diagnosis) {
  std::erase_if(diagnosis.effects,
                [](const diagnose::EffectFinding& finding) { return !finding.asserted(); });
}

}  // namespace patella::bench
