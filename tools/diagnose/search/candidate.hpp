// How a candidate enters a fit: in place of the terms that it contains, and without what other terms already
// say.
#pragma once

#include <optional>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/search/screening.hpp"

namespace patella::diagnose {

/// The recipe without the coefficients that are not marked.
std::shared_ptr<const Recipe> reduced(const std::shared_ptr<const Recipe>& recipe,
                                      const std::vector<bool>& kept);

/// Whether the terms of the fit that a candidate does not replace give any torque that it can.
bool givenByOthers(ModelFitter& fitter, const ModelFit& fit, const Atom& atom);

/// A fit with a candidate as last term, ready to be fitted; nothing where the terms of the fit already give
/// any torque that the candidate can. Coefficients that only repeat what other effects give are left out:
/// what the sum is made of could not be told, and any shares would fit. An effect without coefficients begins
/// where `screened` says, or where its atom is.
std::optional<ModelFit> withCandidate(ModelFitter& fitter, const ModelFit& fit, const Atom& atom,
                                      const Screened& screened);

/// A fit without one of its terms, and with the declared ones back that it had replaced.
ModelFit withoutTerm(const ModelFit& fit, std::size_t term);

}  // namespace patella::diagnose
