// The whole procedure on a simulated rig that shares no dynamics with the model.
#pragma once

#include <array>

#include "tools/bench/diagnose/cases.hpp"
#include "tools/diagnose/diagnose.hpp"

namespace patella::bench {

inline diagnose::Diagnosis diagnosed(const Case& drawn) {
  const std::array recordings{drawn.run.recording};
  return diagnose::diagnose(recordings, {}, drawn.nominal, {});
}

}  // namespace patella::bench
