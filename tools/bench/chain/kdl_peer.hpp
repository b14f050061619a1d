// Orocos KDL on the same chain, read from the URDF by other code than this project's.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

namespace patella::bench {

class KdlPeer {
 public:
  /// Throws std::runtime_error when the text is no URDF or has no such chain.
  KdlPeer(const std::string& urdf_text, const std::string& base, const std::string& tip,
          const Eigen::Vector3d& gravity_m_s2);
  ~KdlPeer();
  KdlPeer(const KdlPeer&) = delete;
  KdlPeer& operator=(const KdlPeer&) = delete;

  int joints() const noexcept;
  void setState(const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& dq);
  /// Inertia matrix, velocity torque and gravity torque at that state.
  void evaluate();
  /// Of the end point, 3 x joints, at that state.
  Eigen::MatrixXd jacobian();

  const Eigen::MatrixXd& inertia() const noexcept;
  const Eigen::VectorXd& velocity_Nm() const noexcept;
  const Eigen::VectorXd& gravity_Nm() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patella::bench
