// Several chains on one fixed base that meet nowhere else, such as the two legs of a rig.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/model/serial_chain.hpp"

namespace patella::model {

/// One after the other: the joints of the first chain come first.
struct ChainGroupParameters {
  std::vector<SerialChainParameters> chains;

  int joints() const noexcept;
};

/// No chain moves another, so inertia and Coriolis matrix have a block for each chain, and zeros elsewhere.
/// The end point, in jacobian(), is that of the first chain.
class ChainGroup final : public Mechanism {
 public:
  /// Throws std::invalid_argument as SerialChain does, with more than kMaxJoints joints or none, and where
  /// the chains' gravity differs, which is that of their one base.
  explicit ChainGroup(const ChainGroupParameters& parameters);

  ChainGroupParameters parameters() const;
  int chains() const noexcept { return static_cast<int>(chains_.size()); }
  const SerialChain& chain(int index) const noexcept { return chains_[static_cast<std::size_t>(index)]; }

  int joints() const noexcept override { return joints_; }
  int dimensions() const noexcept override { return 3; }
  int jointBefore(int joint) const noexcept override;
  JointMatrix inertia(const JointVector& q) const noexcept override;
  JointMatrix coriolis(const JointVector& q, const JointVector& dq) const noexcept override;
  JointVector gravity(const JointVector& q) const noexcept override;
  RigidBodyTerms rigidBody(const JointVector& q, const JointVector& dq) const noexcept override;
  Jacobian jacobian(const JointVector& q) const noexcept override;
  PointMotion pointMotion(int joint, double distance_m, const JointVector& q,
                          const JointVector& dq) const noexcept override;
  bool hasSegment(int joint) const noexcept override;
  SpaceVector againstGravity() const noexcept override { return chains_.front().againstGravity(); }
  double kineticEnergy(const JointVector& q, const JointVector& dq) const noexcept override;
  /// Each chain's is zero at the height of its own first joint.
  double potentialEnergy(const JointVector& q) const noexcept override;

  int baseParameterCount() const noexcept override { return parameter_count_; }
  BaseParameters baseParameters() const noexcept override;
  Regressor regressor(const JointVector& q, const JointVector& dq,
                      const JointVector& ddq) const noexcept override;

 private:
  /// Where a chain's numbers are among those of all.
  struct Place {
    int first = 0;  ///< joint
    int joints = 0;
    int first_parameter = 0;
    int parameters = 0;
    JointVector of(const JointVector& all) const noexcept { return all.segment(first, joints); }
  };
  /// Of the chain that has the joint.
  std::size_t chainOf(int joint) const noexcept { return chain_of_[static_cast<std::size_t>(joint)]; }

  std::vector<SerialChain> chains_;
  std::vector<Place> places_;
  std::array<std::size_t, kMaxJoints> chain_of_{};
  int joints_ = 0;
  int parameter_count_ = 0;
};

}  // namespace patella::model
