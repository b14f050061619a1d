// A body at a point of the last link of a chain, and the torque that it takes.
#pragma once

#include <Eigen/Core>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Small beside the chain, so that a point has its mass.
struct PointBody {
  double mass_kg = 0.0;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< in the axes of the last link
};

/// The model of a single chain with the body on its last link; other models stay as they are.
model::ModelDescription withBody(model::ModelDescription model, const PointBody& body);

/// Torque of a kilogram at a point of the last link of a single chain, N·m. The dataset must outlive it.
class PointTorque {
 public:
  PointTorque(const Dataset& data, const model::ModelDescription& given);

  Column at(const Eigen::Vector3d& point_m) const;
  /// Change by a metre along each axis, a column each: exact, as the torque is quadratic in the place.
  Eigen::MatrixXd slopes(const Eigen::Vector3d& point_m) const;

 private:
  Column torqueOf(const model::ModelDescription& model) const;

  const Dataset& data_;
  model::ModelDescription bare_;
  Column own_;
};

}  // namespace patella::diagnose
