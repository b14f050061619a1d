#include "core/model/serial_chain.hpp"

#include <stdexcept>

#include <Eigen/Dense>

#include "core/check.hpp"
#include "core/model/chain/probe_states.hpp"
#include "core/model/chain/skew.hpp"

namespace patella::model {
namespace {

using chain::cross;
using chain::Inertia;
using chain::Motion;
using chain::Posture;
using chain::skew;
using chain::Wrench;

constexpr double kShortestSegment_m = 1e-9;
/// Smallest part that the joint's own inertia may be of the diagonal, once those of the others are taken off.
constexpr double kSmallestPivot = 1e-12;

std::size_t indexOf(int joint) noexcept {
  return static_cast<std::size_t>(joint);
}

Inertia inertiaOf(const chain::RigidChain& chain, const Posture& posture, int joint) noexcept {
  const std::size_t i = indexOf(joint);
  return chain::inertiaOf(chain.bodies[i], posture.axes[i], posture.origin[i]);
}

/// Column `joint` of the inertia matrix; `composite` is of the joint's body and all after it. Featherstone,
/// Rigid Body Dynamics Algorithms, Section 6.2.
void fillInertia(const Posture& posture, const Inertia& composite, int joint, JointMatrix& matrix) noexcept {
  const Wrench momentum = composite * posture.joint[indexOf(joint)];
  for (int i = 0; i <= joint; ++i) {
    matrix(i, joint) = matrix(joint, i) = chain::dot(posture.joint[indexOf(i)], momentum);
  }
}

/// Of a joint: what its drive has to hold of the weight of all that it moves.
double gravityTorque(const chain::RigidChain& chain, const Motion& joint, const Inertia& composite) noexcept {
  return -chain::dot(joint, {composite.moment.cross(chain.gravity), composite.mass * chain.gravity});
}

/// Velocity of all bodies, from the base.
struct Velocities {
  std::array<Motion, kMaxJoints> body;
  std::array<Motion, kMaxJoints> joint_rate;  ///< of the joint's direction
};

Velocities velocities(const Posture& posture, const JointVector& dq) noexcept {
  Velocities result;
  Motion velocity{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int i = 0; i < dq.size(); ++i) {
    const Motion& joint = posture.joint[indexOf(i)];
    result.joint_rate[indexOf(i)] = cross(velocity, joint);
    velocity = velocity + dq[i] * joint;
    result.body[indexOf(i)] = velocity;
  }
  return result;
}

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// B with I dv/dt + v × (I v) = I (dv/dt) + B v, such that dI/dt − 2 B is skew-symmetric: half of
/// (v×*) I − I (v×) + (I v)×̄*. Echeandia and Wensing, Numerical methods to compute the Coriolis matrix and
/// Christoffel symbols for rigid-body systems, 2021, Section 3.
Matrix6d velocityFactor(const Inertia& inertia, const Motion& v) noexcept {
  Matrix6d mass;
  mass << chain::matrixOf(inertia.turn), skew(inertia.moment), -skew(inertia.moment),
      inertia.mass * Eigen::Matrix3d::Identity();
  Matrix6d motion;
  motion << skew(v.turn), Eigen::Matrix3d::Zero(), skew(v.shift), skew(v.turn);
  const Wrench momentum = inertia * v;
  Matrix6d of_momentum;
  of_momentum << -skew(momentum.moment), -skew(momentum.force), -skew(momentum.force),
      Eigen::Matrix3d::Zero();
  return 0.5 * (-motion.transpose() * mass - mass * motion + of_momentum);
}

Eigen::Matrix<double, 6, 1> stacked(const Eigen::Vector3d& above, const Eigen::Vector3d& below) noexcept {
  Eigen::Matrix<double, 6, 1> result;
  result << above, below;
  return result;
}

/// Velocity per joint velocity of a point of the body that `last` moves.
Jacobian pointJacobian(const Posture& posture, const Eigen::Vector3d& point, int last, int joints) noexcept {
  Jacobian jacobian = Jacobian::Zero(3, joints);
  for (int i = 0; i <= last; ++i) {
    const Motion& joint = posture.joint[indexOf(i)];
    jacobian.col(i) = joint.shift + joint.turn.cross(point);
  }
  return jacobian;
}

/// Positive pivots at the states that tell the base parameters as well.
void requireInvertible(const SerialChain& chain) {
  for (const chain::ProbeState& state : chain::probeStates(chain.joints())) {
    const JointMatrix inertia = chain.inertia(state.q);
    Eigen::MatrixXd rest = inertia;
    for (int i = chain.joints() - 1; i >= 0; --i) {
      if (!(rest(i, i) > kSmallestPivot * inertia.diagonal().maxCoeff())) {
        rejectValue(
            "serial_chain: inertia that joint " + std::to_string(i + 1) + " moves, with those after it free",
            rest(i, i), "more than 0: a mass or an inertia about its axis");
      }
      const Eigen::VectorXd column = rest.col(i).head(i);
      rest.topLeftCorner(i, i) -= column * column.transpose() / rest(i, i);
    }
  }
}

}  // namespace

SerialChain::SerialChain(const SerialChainParameters& parameters)
    : parameters_(parameters), chain_(parameters), base_(chain_) {
  requireInvertible(*this);
}

ChainTerms SerialChain::terms(const JointVector& q, const JointVector& dq) const noexcept {
  const int n = chain_.joints;
  Posture posture;
  std::array<Inertia, kMaxJoints> inertia;
  std::array<Wrench, kMaxJoints> wrench;
  // Recursive Newton–Euler without joint acceleration and gravity: Featherstone, Section 5.3.
  Motion velocity{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Motion acceleration = velocity;
  for (int joint = 0; joint < n; ++joint) {
    const std::size_t i = indexOf(joint);
    chain::place(chain_, q, joint, posture);
    inertia[i] = chain::inertiaOf(chain_.bodies[i], posture.axes[i], posture.origin[i]);
    const Motion step = dq[joint] * posture.joint[i];
    acceleration = acceleration + cross(velocity, step);
    velocity = velocity + step;
    wrench[i] = inertia[i] * acceleration + cross(velocity, inertia[i] * velocity);
  }
  ChainTerms terms{JointMatrix(n, n), JointVector(n), JointVector(n)};
  for (int joint = n - 1; joint >= 0; --joint) {
    const std::size_t i = indexOf(joint);
    fillInertia(posture, inertia[i], joint, terms.inertia);
    terms.velocity_Nm[joint] = chain::dot(posture.joint[i], wrench[i]);
    terms.gravity_Nm[joint] = gravityTorque(chain_, posture.joint[i], inertia[i]);
    if (joint > 0) {
      inertia[i - 1] += inertia[i];
      wrench[i - 1] = wrench[i - 1] + wrench[i];
    }
  }
  return terms;
}

RigidBodyTerms SerialChain::rigidBody(const JointVector& q, const JointVector& dq) const noexcept {
  const ChainTerms all = terms(q, dq);
  return {all.inertia, all.velocity_Nm + all.gravity_Nm};
}

JointMatrix SerialChain::inertia(const JointVector& q) const noexcept {
  const int n = chain_.joints;
  Posture posture;
  chain::placeUpTo(chain_, q, n - 1, posture);
  JointMatrix matrix(n, n);
  Inertia composite;
  for (int joint = n - 1; joint >= 0; --joint) {
    composite += inertiaOf(chain_, posture, joint);
    fillInertia(posture, composite, joint, matrix);
  }
  return matrix;
}

JointVector SerialChain::gravity(const JointVector& q) const noexcept {
  const int n = chain_.joints;
  Posture posture;
  chain::placeUpTo(chain_, q, n - 1, posture);
  JointVector torque_Nm(n);
  Inertia composite;
  for (int joint = n - 1; joint >= 0; --joint) {
    composite += inertiaOf(chain_, posture, joint);
    torque_Nm[joint] = gravityTorque(chain_, posture.joint[indexOf(joint)], composite);
  }
  return torque_Nm;
}

JointMatrix SerialChain::coriolis(const JointVector& q, const JointVector& dq) const noexcept {
  const int n = chain_.joints;
  Posture posture;
  chain::placeUpTo(chain_, q, n - 1, posture);
  const Velocities moving = velocities(posture, dq);
  JointMatrix matrix(n, n);
  Inertia composite;
  Matrix6d factor = Matrix6d::Zero();
  for (int joint = n - 1; joint >= 0; --joint) {
    const std::size_t j = indexOf(joint);
    const Inertia own = inertiaOf(chain_, posture, joint);
    composite += own;
    factor += velocityFactor(own, moving.body[j]);
    const Motion& direction = posture.joint[j];
    const Wrench of_rate = composite * moving.joint_rate[j];
    const auto along = stacked(direction.turn, direction.shift);
    // Below the diagonal the rate is that of the earlier joint.
    const Eigen::Matrix<double, 6, 1> column = factor * along + stacked(of_rate.moment, of_rate.force);
    const Eigen::Matrix<double, 6, 1> row = factor.transpose() * along;
    const Wrench momentum = composite * direction;
    for (int i = 0; i <= joint; ++i) {
      const Motion& earlier = posture.joint[indexOf(i)];
      const auto along_earlier = stacked(earlier.turn, earlier.shift);
      matrix(i, joint) = along_earlier.dot(column);
      if (i < joint) {
        matrix(joint, i) = along_earlier.dot(row) + chain::dot(moving.joint_rate[indexOf(i)], momentum);
      }
    }
  }
  return matrix;
}

Eigen::Vector3d SerialChain::endPoint(const JointVector& q) const noexcept {
  const int last = chain_.joints - 1;
  Posture posture;
  chain::placeUpTo(chain_, q, last, posture);
  return posture.origin[indexOf(last)] + posture.axes[indexOf(last)] * chain_.end_point;
}

Jacobian SerialChain::jacobian(const JointVector& q) const noexcept {
  const int last = chain_.joints - 1;
  Posture posture;
  chain::placeUpTo(chain_, q, last, posture);
  const Eigen::Vector3d point =
      posture.origin[indexOf(last)] + posture.axes[indexOf(last)] * chain_.end_point;
  return pointJacobian(posture, point, last, chain_.joints);
}

Eigen::Vector3d SerialChain::segment(int joint) const noexcept {
  return joint + 1 < chain_.joints ? chain_.bodies[indexOf(joint + 1)].origin : chain_.end_point;
}

bool SerialChain::hasSegment(int joint) const noexcept {
  return segment(joint).norm() > kShortestSegment_m;
}

PointMotion SerialChain::pointMotion(int joint, double distance_m, const JointVector& q,
                                     const JointVector& dq) const noexcept {
  Posture posture;
  chain::placeUpTo(chain_, q, joint, posture);
  const std::size_t last = indexOf(joint);
  const Eigen::Vector3d point =
      posture.origin[last] + distance_m * (posture.axes[last] * segment(joint).normalized());
  Motion velocity{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Motion acceleration = velocity;
  for (int i = 0; i <= joint; ++i) {
    const Motion step = dq[i] * posture.joint[indexOf(i)];
    acceleration = acceleration + cross(velocity, step);
    velocity = velocity + step;
  }
  const Eigen::Vector3d of_point = velocity.shift + velocity.turn.cross(point);
  return {pointJacobian(posture, point, joint, chain_.joints),
          acceleration.shift + acceleration.turn.cross(point) + velocity.turn.cross(of_point)};
}

double SerialChain::kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept {
  Posture posture;
  chain::placeUpTo(chain_, q, chain_.joints - 1, posture);
  const Velocities moving = velocities(posture, dq);
  double energy_J = 0.0;
  for (int joint = 0; joint < chain_.joints; ++joint) {
    const Motion& velocity = moving.body[indexOf(joint)];
    energy_J += 0.5 * chain::dot(velocity, inertiaOf(chain_, posture, joint) * velocity);
  }
  return energy_J;
}

double SerialChain::potentialEnergy(const JointVector& q) const noexcept {
  Posture posture;
  chain::placeUpTo(chain_, q, chain_.joints - 1, posture);
  double energy_J = 0.0;
  for (int joint = 0; joint < chain_.joints; ++joint) {
    energy_J -= inertiaOf(chain_, posture, joint).moment.dot(chain_.gravity);
  }
  return energy_J;
}

Regressor SerialChain::regressor(const JointVector& q, const JointVector& dq,
                                 const JointVector& ddq) const noexcept {
  return base_.regressor(chain_, q, dq, ddq);
}

}  // namespace patella::model
