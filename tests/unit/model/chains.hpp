// Chains for tests: the leg and single joints as chains, and chains of any kind drawn at random.
#pragma once

#include <random>
#include <string>

#include "core/model/one_dof.hpp"
#include "core/model/planar_two_link.hpp"
#include "core/model/serial_chain.hpp"

namespace patella::test {

inline model::ChainLink frameAt(double x_m) {
  model::ChainLink link;
  link.name = "end point";
  link.joint = model::ChainJoint::kFixed;
  link.origin_m = {x_m, 0.0, 0.0};
  return link;
}

/// x forward, y up, joints about z.
inline model::SerialChainParameters asChain(const model::PlanarTwoLinkParameters& leg) {
  model::SerialChainParameters chain;
  chain.gravity_m_s2 = {0.0, -leg.gravity_m_s2, 0.0};
  for (std::size_t i = 0; i < 2; ++i) {
    model::ChainLink link;
    link.name = i == 0 ? "thigh" : "shank";
    link.origin_m = {i == 0 ? 0.0 : leg.length_m[0], 0.0, 0.0};
    link.mass_kg = leg.mass_kg[i];
    link.com_m = {leg.com_m[i], 0.0, 0.0};
    const double inertia = leg.inertia_kg_m2[i];
    link.inertia_kg_m2 = {0.5 * inertia, 0.7 * inertia, inertia, 0.0, 0.0, 0.0};
    chain.links.push_back(link);
  }
  chain.links.push_back(frameAt(leg.length_m[1]));
  return chain;
}

/// A mass of 2 kg where the moment wants it, and the rest of the inertia about it.
inline model::SerialChainParameters asChain(const model::RevoluteJointParameters& joint) {
  constexpr double kMass_kg = 2.0;
  model::SerialChainParameters chain;
  chain.gravity_m_s2 = {0.0, -joint.gravity_m_s2, 0.0};
  model::ChainLink link;
  link.name = "shank";
  link.mass_kg = kMass_kg;
  link.com_m = {joint.moment_kg_m / kMass_kg, 0.0, 0.0};
  const double rest = joint.inertia_kg_m2 - joint.moment_kg_m * joint.moment_kg_m / kMass_kg;
  link.inertia_kg_m2 = {0.5 * rest, 0.6 * rest, rest, 0.0, 0.0, 0.0};
  chain.links = {link, frameAt(joint.length_m)};
  return chain;
}

inline model::SerialChainParameters asChain(const model::PrismaticJointParameters& axis) {
  model::SerialChainParameters chain;
  chain.gravity_m_s2 = {0.0, -axis.gravity_m_s2, 0.0};
  model::ChainLink link;
  link.name = "carriage";
  link.joint = model::ChainJoint::kPrismatic;
  link.turn_rad = {0.0, 0.0, axis.inclination_rad};
  link.axis = Eigen::Vector3d::UnitX();
  link.mass_kg = axis.mass_kg;
  link.com_m = {0.1, -0.2, 0.3};
  chain.links = {link};
  return chain;
}

/// Revolute and prismatic joints with axes in any direction, fixed links before, between and after, turned
/// frames, full tensors, and the base at any angle to gravity.
class RandomChains {
 public:
  explicit RandomChains(unsigned seed) : random_(seed) {}

  model::SerialChainParameters draw(int joints) {
    model::SerialChainParameters chain;
    chain.gravity_m_s2 = 9.81 * direction();
    for (int i = 0; i < joints; ++i) {
      if (uniform(0.0, 1.0) < 0.4) {
        chain.links.push_back(link(model::ChainJoint::kFixed));
      }
      chain.links.push_back(
          link(uniform(0.0, 1.0) < 0.3 ? model::ChainJoint::kPrismatic : model::ChainJoint::kRevolute));
    }
    chain.links.push_back(link(model::ChainJoint::kFixed));
    return chain;
  }

  double uniform(double from, double to) { return std::uniform_real_distribution(from, to)(random_); }
  Eigen::Vector3d vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  Eigen::Vector3d direction() { return (vector(1.0) + Eigen::Vector3d(1e-3, 0.0, 0.0)).normalized(); }

 private:
  model::ChainLink link(model::ChainJoint joint) {
    model::ChainLink link;
    link.name = "link";
    link.joint = joint;
    link.origin_m = vector(0.4);
    link.turn_rad = vector(3.0);
    link.axis = uniform(0.3, 1.0) * direction();
    link.mass_kg = uniform(0.2, 6.0);
    link.com_m = vector(0.2);
    // Of three rods along the principal axes: any body's moments are such sums.
    const Eigen::Matrix3d axes = model::rotationOf(vector(3.0));
    const Eigen::Vector3d rods(uniform(0.001, 0.05), uniform(0.001, 0.05), uniform(0.001, 0.05));
    const Eigen::Vector3d principal = Eigen::Vector3d::Constant(rods.sum()) - rods;
    const Eigen::Matrix3d inertia = axes * principal.asDiagonal() * axes.transpose();
    link.inertia_kg_m2 = {inertia(0, 0), inertia(1, 1), inertia(2, 2),
                          inertia(0, 1), inertia(0, 2), inertia(1, 2)};
    return link;
  }

  std::mt19937 random_;
};

}  // namespace patella::test
