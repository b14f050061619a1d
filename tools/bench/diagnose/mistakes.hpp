// Mistakes that people make with the columns of a recording, drawn and made.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "tools/bench/diagnose/random.hpp"
#include "tools/diagnose/checks/convention.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::bench {

struct Mistake {
  std::string kind;  ///< "sign of one torque"
  std::string text;  ///< "tau2 × −1"
  std::function<void(diagnose::Recording&)> make;
  std::function<bool(const diagnose::Convention&)> is;  ///< true for what puts it right
};

/// Draws one for a recording of revolute joints whose files count the first angle from hanging down, or of a
/// rail. None where the kind that was drawn takes two joints, or angles, and there are none.
std::optional<Mistake> drawMistake(const diagnose::Recording& recording, bool revolute, Random& random);

}  // namespace patella::bench
