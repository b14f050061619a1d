// The leg in the sagittal plane: two rigid links in series, hip and knee.
#pragma once

#include <array>

#include "core/model/mechanism.hpp"

namespace patella::model {

/// Index 0 is the thigh, 1 the shank.
struct PlanarTwoLinkParameters {
  std::array<double, 2> mass_kg{};
  std::array<double, 2> length_m{};       ///< joint to next joint, and knee to end point
  std::array<double, 2> com_m{};          ///< joint to centre of mass, along the link
  std::array<double, 2> inertia_kg_m2{};  ///< about the centre of mass
  double gravity_m_s2 = 9.81;
};

/// q = (hip angle from the horizontal, knee angle relative to the thigh), rad; hanging is (−π/2, 0).
/// Equations (1)–(6) of the paper with its errors in (3), (4) and (6) corrected.
class PlanarTwoLink final : public Mechanism {
 public:
  /// Throws std::invalid_argument naming the parameter and its value unless masses and lengths are positive,
  /// distances, inertias and gravity not negative, and each link has inertia about its own joint.
  explicit PlanarTwoLink(const PlanarTwoLinkParameters& parameters);

  const PlanarTwoLinkParameters& parameters() const noexcept { return parameters_; }

  int joints() const noexcept override { return 2; }
  JointMatrix inertia(const JointVector& q) const noexcept override;
  JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept override;
  JointVector gravity(const JointVector& q) const noexcept override;
  Jacobian jacobian(const JointVector& q) const noexcept override;
  PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                          const JointVector& dq) const noexcept override;
  SpaceVector againstGravity() const noexcept override {
    return Eigen::Vector2d(0.0, parameters_.gravity_m_s2);
  }
  double kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept override;
  double potentialEnergy(const JointVector& q) const noexcept override;

  /// [I1 + m1 lc1² + m2 l1², I2 + m2 lc2², m2 l1 lc2, m1 lc1 + m2 l1, m2 lc2]
  int baseParameterCount() const noexcept override { return 5; }
  BaseParameters baseParameters() const noexcept override;
  Regressor regressor(const JointVector& q, const JointVector& dq,
                      const JointVector& ddq) const noexcept override;

 private:
  PlanarTwoLinkParameters parameters_;
  // Base parameters, which are all that the equations of motion need.
  double thigh_inertia_;  // about the hip, shank's mass taken at the knee, kg·m²
  double shank_inertia_;  // about the knee, kg·m²
  double coupling_;       // m2 l1 lc2, kg·m²
  double thigh_moment_;   // first moment about the hip, shank's mass taken at the knee, kg·m
  double shank_moment_;   // first moment about the knee, kg·m
};

}  // namespace patella::model
