// One thing that a real-time host must, or had better, have, and whether it has it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace patella::app {

struct Finding {
  std::string name;  ///< stable identifier, snake_case
  bool ok = false;
  bool required = true;  ///< false: worth fixing, but the loop can keep its promises without
  std::string found;
  std::string expected;
  std::string fix;             ///< what to do; empty when ok
  bool indispensable = false;  ///< without it no torque ever flows
};

/// True when every required finding is ok.
inline bool allRequiredOk(const std::vector<Finding>& findings) {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return f.ok || !f.required; });
}

/// True when torque could flow.
inline bool allIndispensableOk(const std::vector<Finding>& findings) {
  return std::all_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.ok || !f.indispensable; });
}

}  // namespace patella::app
