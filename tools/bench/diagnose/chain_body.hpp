// Rigid body of a serial chain, written without patella_core's: Kane's equations with the partial velocities
// of each link's centre of mass, everything in the axes of the base. tests/unit/bench_chain holds it to
// Orocos KDL.
//
// Source: Kane, Levinson, Dynamics: Theory and Applications, 1985, Sections 2.14 and 6.1.
#pragma once

#include <vector>

#include "core/model/chain/chain_parameters.hpp"
#include "core/types.hpp"

namespace patella::bench {

class ChainBody {
 public:
  explicit ChainBody(const model::SerialChainParameters& parameters);

  struct Terms {
    JointMatrix inertia;  ///< kg·m², kg for a prismatic joint
    JointVector bias_Nm;  ///< what moves the joints without acceleration
  };
  Terms terms(const PerJoint& q, const PerJoint& dq);
  PerJoint inverseDynamics(const PerJoint& q, const PerJoint& dq, const PerJoint& ddq);
  /// Kinetic and potential, J.
  double energy(const PerJoint& q, const PerJoint& dq);

  std::size_t joints() const noexcept { return joints_; }

 private:
  struct Link {
    int joint = -1;  // that moves it; -1: fixed
    bool turns = false;
    Eigen::Vector3d origin_m, axis, com_m;
    Eigen::Matrix3d turn, inertia_kg_m2;
    double mass_kg = 0.0;
    // At the pose, in the axes of the base.
    Eigen::Matrix3d rotation, tensor;
    Eigen::Vector3d place, step, direction, centre;  // step: from the place of the link before
  };

  void pose(const PerJoint& q);
  PerJoint torqueAtPose(const PerJoint& dq, const PerJoint& ddq) const;
  JointMatrix inertiaAtPose() const;

  std::vector<Link> links_;
  std::size_t joints_ = 0;
  Eigen::Vector3d gravity_;
};

/// Where the link that `joint` moves stands among the links. Throws std::invalid_argument beyond the joints.
std::size_t linkOfJoint(const model::SerialChainParameters& chain, std::size_t joint);

/// Adds a point mass to a link, at a place in the link's frame.
void addPointMass(model::ChainLink& link, double mass_kg, const Eigen::Vector3d& place_m);

/// The link's tensor about its centre of mass as a matrix, and back.
Eigen::Matrix3d tensorOf(const model::ChainLink& link);
void setTensor(model::ChainLink& link, const Eigen::Matrix3d& tensor_kg_m2);

}  // namespace patella::bench
