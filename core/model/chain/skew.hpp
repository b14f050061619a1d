// The matrix of a cross product.
#pragma once

#include <Eigen/Core>

namespace patella::model::chain {

/// S with S w = v × w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) noexcept {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

}  // namespace patella::model::chain
