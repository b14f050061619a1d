#include "core/model/chain/rigid_chain.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace patella::model::chain {
namespace {

/// Moment of inertia of a mass at `at` about the origin.
Eigen::Matrix3d ofPoint(double mass, const Eigen::Vector3d& at) noexcept {
  return mass * (at.squaredNorm() * Eigen::Matrix3d::Identity() - at * at.transpose());
}

/// Sum of links in one frame, about its origin.
struct Sum {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();

  void add(const ChainLink& link, const Eigen::Matrix3d& axes, const Eigen::Vector3d& origin) {
    const auto [xx, yy, zz, xy, xz, yz] = link.inertia_kg_m2;
    const Eigen::Vector3d com = origin + axes * link.com_m;
    mass += link.mass_kg;
    moment += link.mass_kg * com;
    inertia += axes * matrixOf({xx, yy, zz, xy, xz, yz}) * axes.transpose() + ofPoint(link.mass_kg, com);
  }
};

void setInertia(Body& body, const Sum& sum) {
  body.mass = sum.mass;
  if (sum.mass > 0.0) {
    body.com = sum.moment / sum.mass;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum.inertia - ofPoint(sum.mass, body.com));
  const Eigen::Vector3d principal = solver.eigenvalues();
  body.around = principal[1];
  body.excess = {principal[0] - principal[1], principal[2] - principal[1]};
  body.axes << solver.eigenvectors().col(0), solver.eigenvectors().col(2);
}

}  // namespace

RigidChain::RigidChain(const SerialChainParameters& parameters)
    : end_point(Eigen::Vector3d::Zero()), gravity(checked(parameters).gravity_m_s2) {
  // Of the newest link, in the frame of the newest body, which is the base's at first.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Sum sum;
  for (const ChainLink& link : parameters.links) {
    origin += axes * link.origin_m;
    axes = axes * rotationOf(link.turn_rad);
    if (link.joint != ChainJoint::kFixed) {
      if (joints > 0) {
        setInertia(bodies[static_cast<std::size_t>(joints - 1)], sum);
      }
      sum = {};
      Body& body = bodies[static_cast<std::size_t>(joints++)];
      const Eigen::Matrix3d along =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), link.axis).toRotationMatrix();
      body.revolute = link.joint == ChainJoint::kRevolute;
      body.turned = axes * along;
      body.origin = origin;
      body.link = along.transpose();
      axes = body.link;
      origin.setZero();
    }
    sum.add(link, axes, origin);
  }
  setInertia(bodies[static_cast<std::size_t>(joints - 1)], sum);
  end_point = origin;
}

void place(const RigidChain& chain, const JointVector& q, int joint, Posture& posture) noexcept {
  const auto i = static_cast<std::size_t>(joint);
  const Body& body = chain.bodies[i];
  Eigen::Matrix3d& axes = posture.axes[i];
  Eigen::Vector3d& origin = posture.origin[i];
  if (joint == 0) {
    axes = body.turned;
    origin.setZero();
  } else {
    axes.noalias() = posture.axes[i - 1] * body.turned;
    origin.noalias() = posture.origin[i - 1] + posture.axes[i - 1] * body.origin;
  }
  const Eigen::Vector3d z = axes.col(2);
  if (!body.revolute) {
    origin += q[joint] * z;
    posture.joint[i] = {Eigen::Vector3d::Zero(), z};
    return;
  }
  const double c = std::cos(q[joint]);
  const double s = std::sin(q[joint]);
  const Eigen::Vector3d x = axes.col(0);
  const Eigen::Vector3d y = axes.col(1);
  axes.col(0) = c * x + s * y;
  axes.col(1) = c * y - s * x;
  posture.joint[i] = {z, origin.cross(z)};
}

void placeUpTo(const RigidChain& chain, const JointVector& q, int joint, Posture& posture) noexcept {
  for (int i = 0; i <= joint; ++i) {
    place(chain, q, i, posture);
  }
}

Inertia inertiaOf(const Body& body, const Eigen::Matrix3d& axes, const Eigen::Vector3d& origin) noexcept {
  const Eigen::Vector3d com = origin + axes * body.com;
  const Eigen::Vector3d moment = body.mass * com;
  const Eigen::Vector3d u = axes * body.axes.col(0);
  const Eigen::Vector3d v = axes * body.axes.col(1);
  const Eigen::Vector3d eu = body.excess[0] * u;
  const Eigen::Vector3d ev = body.excess[1] * v;
  const double xx = moment.x() * com.x();
  const double yy = moment.y() * com.y();
  const double zz = moment.z() * com.z();
  return {body.mass,
          moment,
          {body.around + eu.x() * u.x() + ev.x() * v.x() + yy + zz,
           body.around + eu.y() * u.y() + ev.y() * v.y() + xx + zz,
           body.around + eu.z() * u.z() + ev.z() * v.z() + xx + yy,
           eu.x() * u.y() + ev.x() * v.y() - moment.x() * com.y(),
           eu.x() * u.z() + ev.x() * v.z() - moment.x() * com.z(),
           eu.y() * u.z() + ev.y() * v.z() - moment.y() * com.z()}};
}

StandardParameters standardParameters(const Body& body) noexcept {
  const Inertia own = inertiaOf(body, body.link.transpose(), Eigen::Vector3d::Zero());
  StandardParameters values;
  values << own.turn.xx, own.turn.xy, own.turn.xz, own.turn.yy, own.turn.yz, own.turn.zz, own.moment,
      own.mass;
  return values;
}

}  // namespace patella::model::chain
