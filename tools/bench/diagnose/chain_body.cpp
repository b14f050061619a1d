#include "tools/bench/diagnose/chain_body.hpp"

#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace patella::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

ChainBody::ChainBody(const model::SerialChainParameters& parameters) : gravity_(parameters.gravity_m_s2) {
  for (const model::ChainLink& given : parameters.links) {
    Link link;
    link.turns = given.joint == model::ChainJoint::kRevolute;
    if (given.joint != model::ChainJoint::kFixed) {
      link.joint = static_cast<int>(joints_++);
    }
    link.origin_m = given.origin_m;
    link.turn = (Eigen::AngleAxisd(given.turn_rad.z(), Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(given.turn_rad.y(), Vector3d::UnitY()) *
                 Eigen::AngleAxisd(given.turn_rad.x(), Vector3d::UnitX()))
                    .toRotationMatrix();
    link.axis = given.axis.normalized();
    link.mass_kg = given.mass_kg;
    link.com_m = given.com_m;
    link.inertia_kg_m2 = tensorOf(given);
    links_.push_back(link);
  }
}

void ChainBody::pose(const PerJoint& q) {
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d place = Vector3d::Zero();
  for (Link& link : links_) {
    link.step = rotation * link.origin_m;
    rotation = rotation * link.turn;
    link.direction = rotation * link.axis;
    if (link.joint >= 0) {
      const double moved = q[static_cast<std::size_t>(link.joint)];
      if (link.turns) {
        rotation = rotation * Eigen::AngleAxisd(moved, link.axis).toRotationMatrix();
      } else {
        link.step += moved * link.direction;
      }
    }
    place += link.step;
    link.place = place;
    link.rotation = rotation;
    link.centre = place + rotation * link.com_m;
    link.tensor = rotation * link.inertia_kg_m2 * rotation.transpose();
  }
}

PerJoint ChainBody::torqueAtPose(const PerJoint& dq, const PerJoint& ddq) const {
  // Inertial force and moment of each link …
  std::vector<Vector3d> force(links_.size()), moment(links_.size());
  Vector3d omega = Vector3d::Zero(), alpha = Vector3d::Zero(), acceleration = Vector3d::Zero();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    acceleration += alpha.cross(link.step) + omega.cross(omega.cross(link.step));
    if (link.joint >= 0) {
      const auto j = static_cast<std::size_t>(link.joint);
      if (link.turns) {
        alpha += ddq[j] * link.direction + dq[j] * omega.cross(link.direction);
        omega += dq[j] * link.direction;
      } else {
        acceleration += ddq[j] * link.direction + 2.0 * dq[j] * omega.cross(link.direction);
      }
    }
    const Vector3d lever = link.centre - link.place;
    const Vector3d of_centre = acceleration + alpha.cross(lever) + omega.cross(omega.cross(lever));
    force[i] = link.mass_kg * (of_centre - gravity_);
    moment[i] = link.tensor * alpha + omega.cross(link.tensor * omega);
  }
  // … by the partial velocities of the joints before it: sums from the end inwards, moments about the base.
  PerJoint torque{};
  Vector3d all_force = Vector3d::Zero(), all_moment = Vector3d::Zero();
  for (std::size_t i = links_.size(); i-- > 0;) {
    const Link& link = links_[i];
    all_force += force[i];
    all_moment += moment[i] + link.centre.cross(force[i]);
    if (link.joint >= 0) {
      torque[static_cast<std::size_t>(link.joint)] =
          link.turns ? link.direction.dot(all_moment - link.place.cross(all_force))
                     : link.direction.dot(all_force);
    }
  }
  return torque;
}

JointMatrix ChainBody::inertiaAtPose() const {
  const auto n = static_cast<Eigen::Index>(joints_);
  JointMatrix inertia = JointMatrix::Zero(n, n);
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJoints> linear(3, n), angular(3, n);
  std::array<const Link*, kMaxJoints> mover{};
  Eigen::Index before = 0;  // joints up to this link
  for (const Link& link : links_) {
    if (link.joint >= 0) {
      mover[static_cast<std::size_t>(before++)] = &link;
    }
    if (link.mass_kg == 0.0) {
      continue;
    }
    for (Eigen::Index j = 0; j < before; ++j) {
      const Link& by = *mover[static_cast<std::size_t>(j)];
      linear.col(j) = by.turns ? by.direction.cross(link.centre - by.place) : by.direction;
      angular.col(j) = by.turns ? by.direction : Vector3d::Zero();
    }
    for (Eigen::Index j = 0; j < before; ++j) {
      const Vector3d turned = link.tensor * angular.col(j);
      for (Eigen::Index k = 0; k <= j; ++k) {
        inertia(j, k) += link.mass_kg * linear.col(j).dot(linear.col(k)) + turned.dot(angular.col(k));
      }
    }
  }
  return inertia.selfadjointView<Eigen::Lower>();
}

ChainBody::Terms ChainBody::terms(const PerJoint& q, const PerJoint& dq) {
  pose(q);
  const PerJoint bias = torqueAtPose(dq, {});
  return {.inertia = inertiaAtPose(),
          .bias_Nm = Eigen::Map<const Eigen::VectorXd>(bias.data(), static_cast<Eigen::Index>(joints_))};
}

PerJoint ChainBody::inverseDynamics(const PerJoint& q, const PerJoint& dq, const PerJoint& ddq) {
  pose(q);
  return torqueAtPose(dq, ddq);
}

double ChainBody::energy(const PerJoint& q, const PerJoint& dq) {
  pose(q);
  const Eigen::Map<const Eigen::VectorXd> rate(dq.data(), static_cast<Eigen::Index>(joints_));
  double energy = 0.5 * rate.dot(inertiaAtPose() * rate);
  for (const Link& link : links_) {
    energy -= link.mass_kg * gravity_.dot(link.centre);
  }
  return energy;
}

std::size_t linkOfJoint(const model::SerialChainParameters& chain, std::size_t joint) {
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    if (chain.links[i].joint != model::ChainJoint::kFixed && joint-- == 0) {
      return i;
    }
  }
  throw std::invalid_argument("the chain has " + std::to_string(chain.joints()) +
                              " joints, expected one of them");
}

void addPointMass(model::ChainLink& link, double mass_kg, const Vector3d& place_m) {
  const double together_kg = link.mass_kg + mass_kg;
  const Vector3d apart = place_m - link.com_m;
  // Parallel axes: the reduced mass at the distance between link and point.
  const double reduced_kg = link.mass_kg * mass_kg / together_kg;
  setTensor(link, tensorOf(link) +
                      reduced_kg * (apart.squaredNorm() * Matrix3d::Identity() - apart * apart.transpose()));
  link.com_m += mass_kg / together_kg * apart;
  link.mass_kg = together_kg;
}

Matrix3d tensorOf(const model::ChainLink& link) {
  const auto& [xx, yy, zz, xy, xz, yz] = link.inertia_kg_m2;
  Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return tensor;
}

void setTensor(model::ChainLink& link, const Matrix3d& tensor_kg_m2) {
  link.inertia_kg_m2 = {tensor_kg_m2(0, 0), tensor_kg_m2(1, 1), tensor_kg_m2(2, 2),
                        tensor_kg_m2(0, 1), tensor_kg_m2(0, 2), tensor_kg_m2(1, 2)};
}

}  // namespace patella::bench
