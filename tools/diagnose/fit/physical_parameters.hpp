// The numbers of a mechanism that a fit may move: masses, centres of mass, inertias.
#pragma once

#include <string>
#include <vector>

#include "core/bounds/bounds.hpp"
#include "core/model/model_description.hpp"

namespace patella::diagnose {

struct PhysicalParameter {
  std::string name;  ///< as in the model's file, with the link's number: "com_m[2]"
  double* value;
  Bound bound;  ///< that a model file has to keep
};

/// Those of `mechanism`, which must outlive them; without those that are zero, which have no ratio.
std::vector<PhysicalParameter> physicalParameters(model::MechanismDescription& mechanism);

}  // namespace patella::diagnose
