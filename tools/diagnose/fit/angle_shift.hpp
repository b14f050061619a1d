// Change of a mechanism's regressor or torque by an encoder's offset, as a function of the offset.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "core/model/mechanism.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Hundreds of offsets are tried, and each one has to be evaluated and filtered. Links beyond the joint
/// are one rigid body for whatever comes before it, and the inertia of a body is quadratic in its rotation or
/// displacement: so are the inertia matrix and its derivatives, and gravity is linear. So regressor and
/// torque are trigonometric polynomials of order 2, and five offsets give any other. Where the joint slides,
/// they are polynomials of order 2, and three are enough.
class AngleShift {
 public:
  /// Of the regressor. `data` and `mechanism` have to last while it is constructed only.
  static AngleShift ofRegressor(const Dataset& data, const model::Mechanism& mechanism, int joint,
                                bool slides);
  /// Of the torque that the mechanism's own parameters ask for: one column, and far less to evaluate.
  static AngleShift ofTorque(const Dataset& data, const model::Mechanism& mechanism, int joint, bool slides);

  /// Columns with the offset on the joint less those without; rad or m.
  Eigen::MatrixXd at(double offset) const;

 private:
  AngleShift(const std::function<Eigen::MatrixXd(const JointVector& offset)>& columns, int joints, int joint,
             bool slides);

  bool slides_;
  Eigen::Index rows_ = 0;
  Eigen::MatrixXd parts_;  ///< columns that go with each function of the offset, as one
};

}  // namespace patella::diagnose
