#include "core/model/chain/chain_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"
#include "core/types.hpp"

namespace patella::model {
namespace {

constexpr double kShortestAxis = 1e-6;
constexpr double kRounding = 1e-9;  // of the largest principal moment, below which a negative one is 0

std::string nameOf(const ChainLink& link, std::size_t index) {
  return "link " + std::to_string(index + 1) + " '" + link.name + "': ";
}

template <typename Values>
void requireAll(const std::string& link, const Bound& bound, const Values& values) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(values.size()); ++i) {
    const auto index = static_cast<typename Values::size_type>(i);
    requireBound(bound, values[index], link + std::string(bound.key()) + "[" + std::to_string(i + 1) + "]");
  }
}

void requireAll(const std::string& link, const Bound& bound, const Eigen::Vector3d& values) {
  requireAll(link, bound, std::array<double, 3>{values[0], values[1], values[2]});
}

void requireBody(const std::string& name, const ChainLink& link) {
  requireBound(boundOf("mechanism.link.mass_kg (serial_chain)"), link.mass_kg, name + "mass_kg");
  requireAll(name, boundOf("mechanism.link.com_m (serial_chain)"), link.com_m);
  requireAll(name, boundOf("mechanism.link.inertia_kg_m2 (serial_chain)"), link.inertia_kg_m2);
  const auto [xx, yy, zz, xy, xz, yz] = link.inertia_kg_m2;
  Eigen::Matrix3d inertia;
  inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  if (link.mass_kg == 0.0 && inertia.cwiseAbs().maxCoeff() > 0.0) {
    rejectValue(name + "mass_kg", 0.0,
                "more than 0 with an inertia of up to " + shortestText(inertia.cwiseAbs().maxCoeff()) +
                    " kg·m², or both 0 for a frame");
  }
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  const double largest = principal.cwiseAbs().maxCoeff();
  if (principal[0] < -kRounding * largest) {
    rejectValue(name + "inertia_kg_m2: principal moment", principal[0], "none below 0");
  }
  if (principal[2] - principal[0] - principal[1] > kTriangleTolerance * largest) {
    rejectValue(name + "inertia_kg_m2: largest principal moment", principal[2],
                "at most the sum of the other two, " + shortestText(principal[0] + principal[1]) +
                    " kg·m², as every body's is (to 0.1 %)");
  }
}

}  // namespace

int SerialChainParameters::joints() const noexcept {
  return static_cast<int>(std::count_if(
      links.begin(), links.end(), [](const ChainLink& link) { return link.joint != ChainJoint::kFixed; }));
}

const SerialChainParameters& checked(const SerialChainParameters& parameters) {
  if (const int joints = parameters.joints(); joints < 1 || joints > kMaxJoints) {
    throw std::invalid_argument("serial_chain: " + std::to_string(joints) +
                                " joints that are not fixed, expected 1 to " + std::to_string(kMaxJoints));
  }
  requireAll("", boundOf("mechanism.gravity_m_s2 (serial_chain)"), parameters.gravity_m_s2);
  requireBound(boundOf("mechanism.gravity_m_s2"), parameters.gravity_m_s2.norm(),
               "magnitude of gravity_m_s2");
  bool moves = false;
  for (std::size_t i = 0; i < parameters.links.size(); ++i) {
    const ChainLink& link = parameters.links[i];
    const std::string name = nameOf(link, i);
    requireAll(name, boundOf("mechanism.link.origin_m (serial_chain)"), link.origin_m);
    requireAll(name, boundOf("mechanism.link.turn_rad (serial_chain)"), link.turn_rad);
    if (link.joint != ChainJoint::kFixed) {
      moves = true;
      requireAll(name, boundOf("mechanism.link.axis (serial_chain)"), link.axis);
      if (link.axis.norm() < kShortestAxis) {
        rejectValue(name + "length of axis", link.axis.norm(), "a direction");
      }
    }
    if (moves) {
      requireBody(name, link);
    }
  }
  return parameters;
}

Eigen::Matrix3d rotationOf(const Eigen::Vector3d& turn_rad) noexcept {
  return (Eigen::AngleAxisd(turn_rad[2], Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(turn_rad[1], Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(turn_rad[0], Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d turnOf(const Eigen::Matrix3d& rotation) noexcept {
  const double yaw = std::atan2(rotation(1, 0), rotation(0, 0));
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  const double pitch = 0.0 - std::atan2(rotation(2, 0), std::hypot(rotation(0, 0), rotation(1, 0)));
  // What is left after yaw is taken back, whatever rounding made of it: near a right angle of pitch the error
  // of one cancels that of the other.
  const double roll =
      std::atan2(s * rotation(0, 2) - c * rotation(1, 2), c * rotation(1, 1) - s * rotation(0, 1));
  return {roll, pitch, yaw};
}

}  // namespace patella::model
