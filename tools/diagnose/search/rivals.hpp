// Rivals: effects that would explain the data as well as a found one does.
#pragma once

#include <cstdint>

#include "tools/diagnose/search/screening.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

struct RivalOptions {
  double unit = 1.0;  ///< what chance brings a parameter, in the units of the fit's objective
  std::uint64_t seed = 1;
  const Dataset* heldout = nullptr;  ///< part of the evidence where there is one; outlives the call
  bool may_exchange = true;          ///< one effect for another
};

/// Puts a rival in the place of a found effect where held-out data say which of them it is: the evidence is
/// the fit's, the cost of parameters, and how each predicts those data. True then: all is to be looked at
/// anew. Else gives each found effect of the selection its gain and, beside the rivals that it has, the
/// labels of those that would do as well in its place.
bool findRivals(ModelFitter& fitter, const Atoms& atoms, const RivalOptions& options, Selection& selection);

}  // namespace patella::diagnose
