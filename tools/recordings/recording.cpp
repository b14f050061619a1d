#include "tools/recordings/recording.hpp"

#include <algorithm>
#include <stdexcept>

namespace patella::diagnose {

const std::vector<std::string>& torqueTimingNames() {
  static const std::vector<std::string> names{"held", "sampled", "before"};
  return names;
}

TorqueTiming torqueTimingNamed(std::string_view name) {
  const std::vector<std::string>& names = torqueTimingNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw std::invalid_argument("timing of a torque '" + std::string(name) +
                                "', expected held, sampled or before");
  }
  return static_cast<TorqueTiming>(found - names.begin());
}

}  // namespace patella::diagnose
