// A link's inertia as ten numbers of any size, each of which makes a body that could be.
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "core/model/chain/chain_parameters.hpp"

namespace patella::diagnose {

/// With the pseudo-inertia Σ of 4 x 4, second moments ∫ r rᵀ dm about the link's origin beside mass times
/// centre of mass and mass, Σ is positive semidefinite exactly where mass and principal moments are positive
/// and keep the triangle inequality. So Σ(x) = L Lᵀ with
///   L = √m exp(x₀/2) [G D(x₁…x₆), c + R (x₇, x₈, x₉)ᵀ; 0, 1],
/// where m, c and m G Gᵀ are the nominal mass, centre of mass and second moments about it, D is upper
/// triangular and the identity at 0, and m R Rᵀ are the second moments about the link's origin. Rucker and
/// Wensing, Smooth Parameterization of Rigid-Body Inertia, IEEE Robotics and Automation Letters 7, 2022, but
/// for the unit of the centre of mass: R takes the link's size from its joint, so that that of a point mass
/// is uncertain, too.
///
/// A number moves nothing where the link has no extent: a thin rod stays thin, and does not tilt.
class LinkBody {
 public:
  static constexpr Eigen::Index kNumbers = 10;
  /// Place of the logarithm of the mass, which scales all of Σ.
  static constexpr Eigen::Index kLogMass = 0;
  using Numbers = Eigen::Matrix<double, kNumbers, 1>;

  /// Of a link with a mass. Principal moments that break the triangle inequality by what a file may
  /// (model::kTriangleTolerance) become those of the nearest body that keeps it.
  explicit LinkBody(const model::ChainLink& nominal);

  /// The link with the body of these numbers, 0 for the nominal one; within the bounds of model files.
  model::ChainLink at(const Numbers& x) const;

  /// Sizes that its standard parameters have by their units: of moments of inertia, kg·m², first moments,
  /// kg·m, and mass, kg.
  std::array<double, 3> sizes() const noexcept { return sizes_; }

 private:
  model::ChainLink nominal_;
  Eigen::Matrix3d extent_;  ///< G, m
  Eigen::Matrix3d reach_;   ///< R, m
  std::array<double, 3> sizes_{};
};

}  // namespace patella::diagnose
