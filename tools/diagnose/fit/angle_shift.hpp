// Change of a mechanism's regressor by an encoder's offset, as a function of the offset.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/model/mechanism.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// A fit asks for hundreds of angles that hardly differ, and each regressor has to be filtered. As a function
/// of the angle it consists of sines and cosines of it, so that a polynomial through eight angles gives any
/// other to 1e-10 of its size within kFarthest_rad (Chebyshev nodes, barycentric form: Berrut and Trefethen,
/// SIAM Review 46, 2004).
class AngleShift {
 public:
  static constexpr double kFarthest_rad = 0.3;

  /// `data` and `mechanism` have to last while it is constructed only.
  AngleShift(const Dataset& data, const model::Mechanism& mechanism, int joint);

  /// regressor(q + angle on the joint) − regressor(q), as Columns; |angle| ≤ kFarthest_rad.
  Eigen::MatrixXd at(double angle_rad) const;

 private:
  std::vector<double> angles_rad_;
  std::vector<double> weights_;
  std::vector<Eigen::MatrixXd> shifts_;
};

}  // namespace patella::diagnose
