#include "tools/bench/diagnose/draw_chain.hpp"

#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "tools/bench/diagnose/constants.hpp"

namespace patella::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using model::ChainJoint;
using model::ChainLink;

constexpr double kGravity_m_s2 = 9.81;

Vector3d anyDirection(Random& random) {
  const Vector3d drawn{random.normal(), random.normal(), random.normal()};  // braces: in this order
  return drawn.normalized();
}

// How an axis, z of its frame, stands to the one before; links go along x.
Vector3d drawTurn(Random& random) {
  switch (random.below(8)) {
    case 0:  // parallel
      return {0.0, 0.0, random.uniform(-kPi, kPi)};
    case 1:  // opposite
      return {kPi, 0.0, 0.0};
    case 2:  // across, to either side
      return {0.5 * kPi, 0.0, 0.0};
    case 3:
      return {-0.5 * kPi, 0.0, 0.0};
    case 4:  // along the link, either way
      return {0.0, 0.5 * kPi, 0.0};
    case 5:
      return {0.0, -0.5 * kPi, 0.0};
    case 6:  // half across
      return {0.25 * kPi * random.sign(), 0.0, 0.0};
    default:  // anyhow
      return {random.uniform(-kPi, kPi), random.uniform(-0.5 * kPi, 0.5 * kPi), random.uniform(-kPi, kPi)};
  }
}

// A box of even density has the tensor; where it sits in the link is another matter.
void setBody(Random& random, double length_m, bool planar, ChainLink& link) {
  const Vector3d side{length_m, random.uniform(0.05, 0.12), random.uniform(0.05, 0.12)};
  const Vector3d square = side.cwiseProduct(side) * (link.mass_kg / 12.0);
  const Matrix3d own =
      Vector3d(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()).asDiagonal();
  const double most_rad = planar ? 0.0 : 0.3;
  const Vector3d about = anyDirection(random);
  const Matrix3d turn = Eigen::AngleAxisd(random.uniform(0.0, most_rad), about).toRotationMatrix();
  setTensor(link, turn * own * turn.transpose());
  const double aside_m = planar ? 0.0 : 0.04;
  const double along = random.uniform(0.3, 0.7);
  const double y = random.uniform(-aside_m, aside_m);
  const double z = random.uniform(-aside_m, aside_m);
  link.com_m = {along * length_m, y, z};
}

// Symmetric root of a symmetric matrix.
Matrix3d rootOf(const Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(matrix);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         solver.eigenvectors().transpose();
}

}  // namespace

Body drawChain(Random& random, std::size_t joints, bool planar) {
  constexpr double kPrismatic = 0.1;
  Body body;
  body.shape = Shape::kChain;
  body.chain.gravity_m_s2 = kGravity_m_s2 * (planar ? Vector3d(-Vector3d::UnitY()) : anyDirection(random));
  Vector3d next = Vector3d::Zero();  // origin of the next joint
  double mass_kg = random.uniform(2.0, 5.0);
  for (std::size_t j = 0; j < joints; ++j) {
    ChainLink link;
    link.name = "link" + std::to_string(j + 1);
    link.joint = !planar && random.chance(kPrismatic) ? ChainJoint::kPrismatic : ChainJoint::kRevolute;
    link.origin_m = next;
    link.turn_rad = planar ? Vector3d::Zero() : drawTurn(random);
    link.mass_kg = mass_kg;
    const double length_m = random.uniform(0.12, 0.35);
    setBody(random, length_m, planar, link);
    const double aside_m = planar ? 0.0 : 0.05;
    const double y = random.uniform(-aside_m, aside_m);
    const double z = random.uniform(-aside_m, aside_m);
    next = {length_m, y, z};
    body.damping_Nms_rad[j] = random.uniform(0.03, 0.1) * mass_kg;
    mass_kg *= random.uniform(0.6, 0.9);
    body.chain.links.push_back(link);
  }
  body.chain.links.push_back({.name = "end point", .joint = ChainJoint::kFixed, .origin_m = next});
  return body;
}

model::SerialChainParameters wrongChain(Random& random, const model::SerialChainParameters& chain,
                                        double error) {
  model::SerialChainParameters wrong = chain;
  const auto drawn = [&] { return random.uniform(-error, error); };
  for (ChainLink& link : wrong.links) {
    if (link.mass_kg == 0.0) {
      continue;
    }
    const double factor = 1.0 + drawn();
    const Matrix3d tensor = tensorOf(link) / link.mass_kg;
    const Matrix3d moments = 0.5 * tensor.trace() * Matrix3d::Identity() - tensor;  // ∫ r rᵀ dm / m
    const Matrix3d extent = rootOf(moments);
    Matrix3d stretch = Matrix3d::Identity();
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index k = 0; k <= i; ++k) {
        stretch(i, k) += 0.5 * drawn();
        stretch(k, i) = stretch(i, k);
      }
    }
    const Matrix3d stretched = link.mass_kg * factor * extent * stretch * stretch * extent;
    setTensor(link, stretched.trace() * Matrix3d::Identity() - stretched);
    const Vector3d shift{drawn(), drawn(), drawn()};
    link.com_m += rootOf(moments + link.com_m * link.com_m.transpose()) * shift;
    link.mass_kg *= factor;
  }
  return wrong;
}

PerJoint loadOf(const Rig& rig) {
  InverseDynamics dynamics(rig.body);
  PerJoint square{};
  int count = 0;
  for (double time_s = 2.0; time_s < rig.duration_s; time_s += 0.02, ++count) {
    const Target target = targetAt(rig.reference, time_s);
    const PerJoint torque = dynamics(target.q, target.dq, target.ddq);
    for (std::size_t j = 0; j < kJoints; ++j) {
      square[j] += torque[j] * torque[j];
    }
  }
  for (double& value : square) {
    value = std::sqrt(value / count);
  }
  return square;
}

bool isSensible(const PerJoint& load_Nm, const Body& body) {
  constexpr double kLeast_Nm = 0.4, kMost_Nm = 150.0, kLeast_N = 4.0, kMost_N = 400.0;
  for (std::size_t j = 0; j < body.joints(); ++j) {
    const bool slides = body.slides(j);
    if (load_Nm[j] < (slides ? kLeast_N : kLeast_Nm) || load_Nm[j] > (slides ? kMost_N : kMost_Nm)) {
      return false;
    }
  }
  return true;
}

}  // namespace patella::bench
