#include "tools/bench/chain/kdl_peer.hpp"

#include <stdexcept>
#include <vector>

#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <urdf_parser/urdf_parser.h>

namespace patella::bench {
namespace {

KDL::Vector vectorOf(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

KDL::Frame frameOf(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  return {KDL::Rotation::Quaternion(r.x, r.y, r.z, r.w), vectorOf(pose.position)};
}

KDL::Joint jointOf(const urdf::Joint& joint) {
  const KDL::Frame at = frameOf(joint.parent_to_joint_origin_transform);
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return KDL::Joint(joint.name, at.p, at.M * vectorOf(joint.axis), KDL::Joint::RotAxis);
    case urdf::Joint::PRISMATIC:
      return KDL::Joint(joint.name, at.p, at.M * vectorOf(joint.axis), KDL::Joint::TransAxis);
    default:
      return KDL::Joint(joint.name, KDL::Joint::Fixed);
  }
}

KDL::RigidBodyInertia bodyOf(const urdf::Link& link) {
  if (!link.inertial) {
    return KDL::RigidBodyInertia::Zero();
  }
  const urdf::Inertial& body = *link.inertial;
  const KDL::Frame at = frameOf(body.origin);
  const KDL::RotationalInertia own(body.ixx, body.iyy, body.izz, body.ixy, body.ixz, body.iyz);
  // Turned by way of a body without mass, as a rotation cannot be applied to the tensor alone.
  const KDL::RigidBodyInertia turned = at.M * KDL::RigidBodyInertia(0.0, KDL::Vector::Zero(), own);
  return KDL::RigidBodyInertia(body.mass, at.p, turned.getRotationalInertia());
}

KDL::Chain chainOf(const std::string& text, const std::string& base, const std::string& tip) {
  const urdf::ModelInterfaceSharedPtr robot = urdf::parseURDF(text);
  if (!robot) {
    throw std::runtime_error("KDL: no URDF");
  }
  std::vector<urdf::LinkConstSharedPtr> way;
  for (urdf::LinkConstSharedPtr link = robot->getLink(tip); link && link->name != base;
       link = link->getParent()) {
    way.push_back(link);
  }
  if (way.empty() || !way.back()->getParent()) {
    throw std::runtime_error("KDL: no chain from " + base + " to " + tip);
  }
  KDL::Chain chain;
  for (auto link = way.rbegin(); link != way.rend(); ++link) {
    const urdf::Joint& joint = *(*link)->parent_joint;
    chain.addSegment(KDL::Segment((*link)->name, jointOf(joint),
                                  frameOf(joint.parent_to_joint_origin_transform), bodyOf(**link)));
  }
  return chain;
}

}  // namespace

struct KdlPeer::State {
  State(KDL::Chain of, const Eigen::Vector3d& g)
      : chain(std::move(of)),
        dynamics(chain, KDL::Vector(g.x(), g.y(), g.z())),
        to_jacobian(chain),
        q(chain.getNrOfJoints()),
        dq(chain.getNrOfJoints()),
        inertia(chain.getNrOfJoints()),
        velocity_Nm(chain.getNrOfJoints()),
        gravity_Nm(chain.getNrOfJoints()) {}

  KDL::Chain chain;
  KDL::ChainDynParam dynamics;
  KDL::ChainJntToJacSolver to_jacobian;
  KDL::JntArray q, dq;
  KDL::JntSpaceInertiaMatrix inertia;
  KDL::JntArray velocity_Nm, gravity_Nm;
};

KdlPeer::KdlPeer(const std::string& urdf_text, const std::string& base, const std::string& tip,
                 const Eigen::Vector3d& gravity_m_s2)
    : state_(std::make_unique<State>(chainOf(urdf_text, base, tip), gravity_m_s2)) {}
KdlPeer::~KdlPeer() = default;

int KdlPeer::joints() const noexcept {
  return static_cast<int>(state_->chain.getNrOfJoints());
}

void KdlPeer::setState(const Eigen::Ref<const Eigen::VectorXd>& q,
                       const Eigen::Ref<const Eigen::VectorXd>& dq) {
  state_->q.data = q;
  state_->dq.data = dq;
}

void KdlPeer::evaluate() {
  state_->dynamics.JntToMass(state_->q, state_->inertia);
  state_->dynamics.JntToCoriolis(state_->q, state_->dq, state_->velocity_Nm);
  state_->dynamics.JntToGravity(state_->q, state_->gravity_Nm);
}

Eigen::MatrixXd KdlPeer::jacobian() {
  KDL::Jacobian found(state_->chain.getNrOfJoints());
  state_->to_jacobian.JntToJac(state_->q, found);
  return found.data.topRows(3);
}

const Eigen::MatrixXd& KdlPeer::inertia() const noexcept {
  return state_->inertia.data;
}
const Eigen::VectorXd& KdlPeer::velocity_Nm() const noexcept {
  return state_->velocity_Nm.data;
}
const Eigen::VectorXd& KdlPeer::gravity_Nm() const noexcept {
  return state_->gravity_Nm.data;
}

}  // namespace patella::bench
