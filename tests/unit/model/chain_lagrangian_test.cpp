// The chain's equations derived a second time, by machine: homogeneous transformations by Rodrigues' formula,
// from them the velocities by a complex step, the Lagrangian from these, and Lagrange's equations by
// differences.
#include <cmath>
#include <complex>
#include <vector>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "tests/unit/model/chains.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

using Complex = std::complex<double>;
using Matrix3c = Eigen::Matrix<Complex, 3, 3>;
using Vector3c = Eigen::Matrix<Complex, 3, 1>;

struct LinkPose {
  const ChainLink* link;
  Matrix3c axes;
  Vector3c com;
};

Matrix3c about(const Eigen::Vector3d& unit, Complex angle) {
  Eigen::Matrix3d k;
  k << 0.0, -unit.z(), unit.y(), unit.z(), 0.0, -unit.x(), -unit.y(), unit.x(), 0.0;
  const Matrix3c kc = k.cast<Complex>();
  return Matrix3c::Identity() + std::sin(angle) * kc + (1.0 - std::cos(angle)) * (kc * kc);
}

std::vector<LinkPose> poses(const SerialChainParameters& chain, const Eigen::VectorXcd& q) {
  std::vector<LinkPose> all;
  Matrix3c axes = Matrix3c::Identity();
  Vector3c origin = Vector3c::Zero();
  Eigen::Index joint = 0;
  for (const ChainLink& link : chain.links) {
    origin += axes * link.origin_m.cast<Complex>();
    const auto& [roll, pitch, yaw] = std::array{link.turn_rad[0], link.turn_rad[1], link.turn_rad[2]};
    axes = axes * about(Eigen::Vector3d::UnitZ(), yaw) * about(Eigen::Vector3d::UnitY(), pitch) *
           about(Eigen::Vector3d::UnitX(), roll);
    const Eigen::Vector3d unit = link.axis.normalized();
    if (link.joint == ChainJoint::kRevolute) {
      axes = (axes * about(unit, q[joint++])).eval();
    } else if (link.joint == ChainJoint::kPrismatic) {
      origin += q[joint++] * (axes * unit.cast<Complex>());
    }
    if (joint > 0) {
      all.push_back({&link, axes, origin + axes * link.com_m.cast<Complex>()});
    }
  }
  return all;
}

double kineticEnergy(const SerialChainParameters& chain, const Eigen::VectorXd& q,
                     const Eigen::VectorXd& dq) {
  constexpr double h = 1e-30;
  const Eigen::VectorXcd moved = q.cast<Complex>() + Complex(0.0, h) * dq.cast<Complex>();
  double energy = 0.0;
  for (const LinkPose& pose : poses(chain, moved)) {
    const Eigen::Vector3d velocity = pose.com.imag() / h;
    const Eigen::Matrix3d turning = pose.axes.imag() / h * pose.axes.real().transpose();
    const Eigen::Vector3d turn =
        pose.axes.real().transpose() * Eigen::Vector3d(turning(2, 1), turning(0, 2), turning(1, 0));
    const auto& [xx, yy, zz, xy, xz, yz] = pose.link->inertia_kg_m2;
    Eigen::Matrix3d inertia;
    inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    energy += 0.5 * pose.link->mass_kg * velocity.squaredNorm() + 0.5 * turn.dot(inertia * turn);
  }
  return energy;
}

double potentialEnergy(const SerialChainParameters& chain, const Eigen::VectorXd& q) {
  double energy = 0.0;
  for (const LinkPose& pose : poses(chain, q.cast<Complex>())) {
    energy -= pose.link->mass_kg * chain.gravity_m_s2.dot(pose.com.real());
  }
  return energy;
}

/// T is quadratic in dq, so polarisation is exact.
Eigen::MatrixXd inertia(const SerialChainParameters& chain, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  Eigen::MatrixXd result(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::VectorXd ei = Eigen::VectorXd::Unit(n, i);
      const Eigen::VectorXd ej = Eigen::VectorXd::Unit(n, j);
      result(i, j) =
          kineticEnergy(chain, q, ei + ej) - kineticEnergy(chain, q, ei) - kineticEnergy(chain, q, ej);
    }
    result(i, i) = 2.0 * kineticEnergy(chain, q, Eigen::VectorXd::Unit(n, i));
  }
  return result;
}

/// To fourth order in the step.
template <typename Function>
auto slope(Function function, const Eigen::VectorXd& q, const Eigen::VectorXd& along) {
  constexpr double h = 1e-3;
  const Eigen::VectorXd step = h * along;
  using Value = decltype(function(q));
  const Value near = function(q + step) - function(q - step);
  const Value far = function(q + 2.0 * step) - function(q - 2.0 * step);
  return Value((8.0 * near - far) / (12.0 * h));
}

}  // namespace

TEST_CASE("a chain's inertia, velocity torque and gravity agree with Lagrange's equations of its links") {
  test::RandomChains random(41);
  for (int joints = 1; joints <= kMaxJoints; ++joints) {
    const SerialChainParameters parameters = random.draw(joints);
    const SerialChain chain(parameters);
    for (const auto& [q, dq, ddq] : test::randomStates(joints, 5)) {
      const Eigen::VectorXd at = q;
      const Eigen::VectorXd unit_rate = dq / dq.norm();
      const ChainTerms terms = chain.terms(q, unit_rate);
      const double largest = terms.inertia.cwiseAbs().maxCoeff();
      CHECK((terms.inertia - inertia(parameters, at)).cwiseAbs().maxCoeff() < 1e-12 * largest);

      // d/dt ∂T/∂dq − ∂T/∂q at ddq = 0, and ∂V/∂q.
      const Eigen::MatrixXd rate = slope(
          [&](const Eigen::VectorXd& x) { return Eigen::MatrixXd(inertia(parameters, x)); }, at, unit_rate);
      Eigen::VectorXd velocity = rate * unit_rate;
      Eigen::VectorXd gravity(joints);
      for (int i = 0; i < joints; ++i) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(joints, i);
        velocity[i] -= slope(
            [&](const Eigen::VectorXd& x) { return kineticEnergy(parameters, x, unit_rate); }, at, unit);
        gravity[i] =
            slope([&](const Eigen::VectorXd& x) { return potentialEnergy(parameters, x); }, at, unit);
      }
      CHECK((terms.velocity_Nm - velocity).cwiseAbs().maxCoeff() < 1e-9 * largest);
      CHECK((terms.gravity_Nm - gravity).cwiseAbs().maxCoeff() <
            1e-9 * (1.0 + gravity.cwiseAbs().maxCoeff()));
      CHECK(chain.kineticEnergy(q, dq) == doctest::Approx(kineticEnergy(parameters, at, dq)).epsilon(1e-12));
    }
  }
}
