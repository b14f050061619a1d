// The chain's terms beside those of Orocos KDL, on the chains of public URDF files.
#include <algorithm>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "core/model/serial_chain.hpp"
#include "firmware_app/files/urdf_file.hpp"
#include "tests/unit/model/random_states.hpp"
#include "tools/bench/chain/kdl_peer.hpp"
#include "tools/bench/chain/robots.hpp"
#include "tools/bench/diagnose/chain_body.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;

namespace {

/// Relative; where the expected number is a small difference of large ones, to a thousandth of these.
template <typename Found, typename Expected>
double difference(const Found& found, const Expected& expected, double terms = 0.0) {
  return (found - expected).norm() / std::max(expected.norm(), 1e-3 * terms);
}

}  // namespace

TEST_CASE(
    "inertia, velocity torque, gravity and Jacobian are those of KDL, on every chain of the URDF files") {
  constexpr double kEqual = 1e-10;
  constexpr int kStates = 1000;
  // The base upright, hanging on a wall, and anyhow.
  const Eigen::Vector3d bases[] = {{0.0, 0.0, -9.81}, {9.81, 0.0, 0.0}, {3.0, -7.0, 5.0}};
  for (const bench::Robot& robot : bench::robots()) {
    CAPTURE(robot.name);
    const std::string text = bench::urdfText(checkout::recordings() / "urdf", robot);
    for (const Eigen::Vector3d& gravity : bases) {
      const model::SerialChain chain(
          {.links = app::parseUrdfChain(text, robot.file, robot.base, robot.tip), .gravity_m_s2 = gravity});
      bench::KdlPeer kdl(text, robot.base, robot.tip, gravity);
      REQUIRE(chain.joints() == kdl.joints());
      double inertia = 0.0, velocity = 0.0, weight = 0.0, jacobian = 0.0;
      for (const auto& [q, dq, ddq] : test::randomStates(chain.joints(), kStates)) {
        const model::ChainTerms terms = chain.terms(q, dq);
        kdl.setState(q, dq);
        kdl.evaluate();
        inertia = std::max(inertia, difference(terms.inertia, kdl.inertia()));
        velocity = std::max(velocity, difference(terms.velocity_Nm, kdl.velocity_Nm(),
                                                 terms.inertia.norm() * dq.squaredNorm()));
        weight = std::max(weight, difference(terms.gravity_Nm, kdl.gravity_Nm(), gravity.norm()));
        jacobian = std::max(jacobian, difference(chain.jacobian(q), kdl.jacobian()));
      }
      CHECK(inertia < kEqual);
      CHECK(velocity < kEqual);
      CHECK(weight < kEqual);
      CHECK(jacobian < kEqual);
    }
  }
}

TEST_CASE("the chain that diagnosis is judged with has the inertia and the torques of KDL") {
  constexpr double kEqual = 1e-10;
  constexpr int kStates = 50;
  const Eigen::Vector3d gravity{3.0, -7.0, 5.0};
  const auto perJoint = [](const JointVector& values) {
    PerJoint result{};
    std::copy(values.begin(), values.end(), result.begin());
    return result;
  };
  for (const bench::Robot& robot : bench::robots()) {
    CAPTURE(robot.name);
    const std::string text = bench::urdfText(checkout::recordings() / "urdf", robot);
    bench::ChainBody chain(
        {.links = app::parseUrdfChain(text, robot.file, robot.base, robot.tip), .gravity_m_s2 = gravity});
    bench::KdlPeer kdl(text, robot.base, robot.tip, gravity);
    REQUIRE(static_cast<int>(chain.joints()) == kdl.joints());
    double inertia = 0.0, bias = 0.0, whole = 0.0;
    for (const auto& [q, dq, ddq] : test::randomStates(kdl.joints(), kStates)) {
      const bench::ChainBody::Terms terms = chain.terms(perJoint(q), perJoint(dq));
      kdl.setState(q, dq);
      kdl.evaluate();
      const Eigen::VectorXd expected_Nm = kdl.velocity_Nm() + kdl.gravity_Nm();
      const double size_Nm = terms.inertia.norm() * dq.squaredNorm() + gravity.norm();
      inertia = std::max(inertia, difference(terms.inertia, kdl.inertia()));
      bias = std::max(bias, difference(terms.bias_Nm, expected_Nm, size_Nm));
      const PerJoint torque = chain.inverseDynamics(perJoint(q), perJoint(dq), perJoint(ddq));
      whole = std::max(whole, difference(Eigen::Map<const Eigen::VectorXd>(torque.data(), kdl.joints()),
                                         Eigen::VectorXd(kdl.inertia() * ddq + expected_Nm), size_Nm));
    }
    CHECK(inertia < kEqual);
    CHECK(bias < kEqual);
    CHECK(whole < kEqual);
  }
}
