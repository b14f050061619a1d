// A selection in fewer or plainer words: an early step did not know yet what the later ones found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

struct RestateOptions {
  double unit = 1.0;     ///< what chance brings a parameter, in the units of the fit's objective
  int replicates = 499;  ///< of the bootstrap that says how well parameters are known
  std::uint64_t seed = 1;
};

/// Puts special cases in the place of what contains them where the information criterion does not speak
/// against it, one level of friction in the place of two that may be equal, and one effect in the place of
/// two that differ from it near rest only; again and again, until nothing changes.
void restate(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options, Selection& selection);

/// The selection with a special case in the place of a found effect, which stays beside it as a rival: the
/// one that explains most. It is the last term. Nothing where the effect has none.
std::optional<Selection> withPlainer(ModelFitter& fitter, const Atoms& atoms, Selection selection,
                                     std::size_t term);

}  // namespace patella::diagnose
