// Named effects that together bend like any function of one variable, and so name nothing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

struct FreeFunction {
  std::vector<std::size_t> terms;  ///< of the selection's fit
  Dependence dependence;           ///< on which variable, and how much of the torque it is

  bool holds(std::size_t term) const { return std::find(terms.begin(), terms.end(), term) != terms.end(); }
};

/// Effects that together are a function of one variable say something even where no parameter of theirs does.
inline bool isPartOf(const std::vector<FreeFunction>& functions, std::size_t term) {
  return std::any_of(functions.begin(), functions.end(),
                     [term](const FreeFunction& function) { return function.holds(term); });
}

/// On one joint: a ripple of fewer cycles than make a period plain beside another torque of position, where a
/// spring that hardens would explain about as much; reflexes against either direction of motion, which add up
/// to a drag.
std::vector<FreeFunction> freeFunctions(const Dataset& data, const Selection& selection);

}  // namespace patella::diagnose
