// What every restatement of a selection is made of: fits with and without some terms, and what they are
// worth.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/diagnose/search/restatement.hpp"
#include "tools/diagnose/search/search.hpp"
#include "tools/diagnose/search/selection.hpp"

namespace patella::diagnose {

/// Changes `selection`, which must outlive it like the fitter and the atoms.
class Restating {
 public:
  Restating(ModelFitter& fitter, const Atoms& atoms, const RestateOptions& options, Selection& selection);

 protected:
  /// Of the last term. Another variant of the same kind has its name, and is no other answer.
  void nameRival(const std::string& label);
  /// Of the found term with this label.
  void nameRival(const std::string& of, const std::string& rival);
  /// Whether anybody would miss what the selection has beyond a smaller fit.
  bool isMissed(const ModelFit& smaller) const;
  /// The term of this kind that was found on a joint.
  std::optional<std::size_t> found(std::string_view kind, int joint) const;
  /// The terms without some of them; not fitted.
  ModelFit without(std::vector<std::size_t> terms) const;
  /// The fit with one more effect; empty where that gives nothing of its own.
  std::optional<ModelFit> added(const ModelFit& fit, const Atom& atom, const std::vector<double>& nu);
  /// Residual of a fit plus the cost of its parameters, without those that the model had already.
  double worth(const ModelFit& fit) const;

  ModelFitter& fitter_;
  const Atoms& atoms_;
  const RestateOptions& options_;
  double unit_;
  double cost_;
  Selection& selection_;
};

}  // namespace patella::diagnose
