// Dependences in the shape that mechanics suggests, beyond the effects of the library. A free function of
// eight knots needs a larger gain for the same.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {

/// Atoms without recipes and their columns, put together one by one.
class FunctionAtoms {
 public:
  explicit FunctionAtoms(const Dataset& data) : data_(&data) {}

  /// `functions` of the state (Dataset::variable()), on one joint.
  void add(const std::string& label, int joint, std::span<const Eigen::VectorXd> functions);
  Atoms finished() &&;

 private:
  const Dataset* data_;
  std::vector<Atom> items_;
  std::vector<Eigen::VectorXd> columns_;
};

/// A muscle or a strap over two joints; stiffness that a muscle brings with it; an inertia that depends on
/// posture; drag; a stop; a load or a gain that changes, which is told from nothing only: those of real
/// drives always do a little, and behind a named effect that is no reason to doubt it.
void addSuggested(const Dataset& data, const ModelFit& fit, std::span<const int> channels,
                  FunctionAtoms& atoms);

/// A spring whose stiffness comes and goes; about any rest on the joints where something of the position was
/// found, for which its mean may pass.
Atoms changingStiffness(const Dataset& data, const ModelFit& fit);

}  // namespace patella::diagnose
