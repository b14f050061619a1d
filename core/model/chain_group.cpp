#include "core/model/chain_group.hpp"

#include <numeric>
#include <stdexcept>

namespace patella::model {
namespace {

const ChainGroupParameters& checked(const ChainGroupParameters& parameters) {
  if (const int joints = parameters.joints(); joints < 1 || joints > kMaxJoints) {
    throw std::invalid_argument("serial_chain: " + std::to_string(parameters.chains.size()) +
                                " chains with " + std::to_string(joints) +
                                " joints that are not fixed, expected 1 to " + std::to_string(kMaxJoints) +
                                " joints together");
  }
  for (std::size_t i = 1; i < parameters.chains.size(); ++i) {
    if (parameters.chains[i].gravity_m_s2 != parameters.chains[0].gravity_m_s2) {
      throw std::invalid_argument("serial_chain: gravity_m_s2 of chain " + std::to_string(i + 1) +
                                  " is not that of chain 1, expected the same: they stand on one base");
    }
  }
  return parameters;
}

}  // namespace

int ChainGroupParameters::joints() const noexcept {
  return std::accumulate(chains.begin(), chains.end(), 0,
                         [](int sum, const SerialChainParameters& chain) { return sum + chain.joints(); });
}

ChainGroup::ChainGroup(const ChainGroupParameters& parameters) {
  for (const SerialChainParameters& one : checked(parameters).chains) {
    try {
      chains_.emplace_back(one);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("chain " + std::to_string(chains_.size() + 1) + ": " + error.what());
    }
    const SerialChain& chain = chains_.back();
    for (int joint = 0; joint < chain.joints(); ++joint) {
      chain_of_[static_cast<std::size_t>(joints_ + joint)] = chains_.size() - 1;
    }
    places_.push_back({.first = joints_,
                       .joints = chain.joints(),
                       .first_parameter = parameter_count_,
                       .parameters = chain.baseParameterCount()});
    joints_ += chain.joints();
    parameter_count_ += chain.baseParameterCount();
  }
}

ChainGroupParameters ChainGroup::parameters() const {
  ChainGroupParameters parameters;
  for (const SerialChain& chain : chains_) {
    parameters.chains.push_back(chain.parameters());
  }
  return parameters;
}

int ChainGroup::jointBefore(int joint) const noexcept {
  return joint == places_[chainOf(joint)].first ? -1 : joint - 1;
}

JointMatrix ChainGroup::inertia(const JointVector& q) const noexcept {
  JointMatrix matrix = JointMatrix::Zero(joints_, joints_);
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    const Place& place = places_[i];
    matrix.block(place.first, place.first, place.joints, place.joints) = chains_[i].inertia(place.of(q));
  }
  return matrix;
}

JointMatrix ChainGroup::coriolis(const JointVector& q, const JointVector& dq) const noexcept {
  JointMatrix matrix = JointMatrix::Zero(joints_, joints_);
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    const Place& place = places_[i];
    matrix.block(place.first, place.first, place.joints, place.joints) =
        chains_[i].coriolis(place.of(q), place.of(dq));
  }
  return matrix;
}

JointVector ChainGroup::gravity(const JointVector& q) const noexcept {
  JointVector torque_Nm(joints_);
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    const Place& place = places_[i];
    torque_Nm.segment(place.first, place.joints) = chains_[i].gravity(place.of(q));
  }
  return torque_Nm;
}

RigidBodyTerms ChainGroup::rigidBody(const JointVector& q, const JointVector& dq) const noexcept {
  RigidBodyTerms all{JointMatrix::Zero(joints_, joints_), JointVector(joints_)};
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    const Place& place = places_[i];
    const RigidBodyTerms own = chains_[i].rigidBody(place.of(q), place.of(dq));
    all.inertia.block(place.first, place.first, place.joints, place.joints) = own.inertia;
    all.bias_Nm.segment(place.first, place.joints) = own.bias_Nm;
  }
  return all;
}

Jacobian ChainGroup::jacobian(const JointVector& q) const noexcept {
  const Place& place = places_.front();
  Jacobian jacobian = Jacobian::Zero(3, joints_);
  jacobian.middleCols(place.first, place.joints) = chains_.front().jacobian(place.of(q));
  return jacobian;
}

PointMotion ChainGroup::pointMotion(int joint, double distance_m, const JointVector& q,
                                    const JointVector& dq) const noexcept {
  const std::size_t i = chainOf(joint);
  const Place& place = places_[i];
  const PointMotion own = chains_[i].pointMotion(joint - place.first, distance_m, place.of(q), place.of(dq));
  PointMotion motion{Jacobian::Zero(3, joints_), own.bias_acceleration};
  motion.jacobian.middleCols(place.first, place.joints) = own.jacobian;
  return motion;
}

bool ChainGroup::hasSegment(int joint) const noexcept {
  const std::size_t i = chainOf(joint);
  return chains_[i].hasSegment(joint - places_[i].first);
}

double ChainGroup::kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept {
  double energy_J = 0.0;
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    energy_J += chains_[i].kineticEnergy(places_[i].of(q), places_[i].of(dq));
  }
  return energy_J;
}

double ChainGroup::potentialEnergy(const JointVector& q) const noexcept {
  double energy_J = 0.0;
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    energy_J += chains_[i].potentialEnergy(places_[i].of(q));
  }
  return energy_J;
}

BaseParameters ChainGroup::baseParameters() const noexcept {
  BaseParameters all(parameter_count_);
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    all.segment(places_[i].first_parameter, places_[i].parameters) = chains_[i].baseParameters();
  }
  return all;
}

Regressor ChainGroup::regressor(const JointVector& q, const JointVector& dq,
                                const JointVector& ddq) const noexcept {
  Regressor rows = Regressor::Zero(joints_, parameter_count_);
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    const Place& place = places_[i];
    rows.block(place.first, place.first_parameter, place.joints, place.parameters) =
        chains_[i].regressor(place.of(q), place.of(dq), place.of(ddq));
  }
  return rows;
}

}  // namespace patella::model
