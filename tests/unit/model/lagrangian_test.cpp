// The leg's equations derived a second time, by machine: from where its masses are and how its links are
// turned, velocities by differentiation of those positions, the Lagrangian from both, and Lagrange's
// equations from it.
#include <array>
#include <cmath>
#include <complex>

#include <doctest/doctest.h>

#include "core/model/planar_two_link.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

const PlanarTwoLinkParameters kLeg{.mass_kg = {7.3, 4.1},
                                   .length_m = {0.42, 0.39},
                                   .com_m = {0.18, 0.24},
                                   .inertia_kg_m2 = {0.13, 0.11},
                                   .gravity_m_s2 = 9.81};

template <typename Scalar>
struct Posture {
  std::array<Scalar, 2> x, y;    // of the centres of mass
  std::array<Scalar, 2> turned;  // of the links
};

template <typename Scalar>
Posture<Scalar> posture(const std::array<Scalar, 2>& q) {
  using std::cos, std::sin;
  const Scalar thigh = q[0];
  const Scalar shank = q[0] + q[1];
  return {.x = {kLeg.com_m[0] * cos(thigh), kLeg.length_m[0] * cos(thigh) + kLeg.com_m[1] * cos(shank)},
          .y = {kLeg.com_m[0] * sin(thigh), kLeg.length_m[0] * sin(thigh) + kLeg.com_m[1] * sin(shank)},
          .turned = {thigh, shank}};
}

/// With velocities by a complex step along dq, which is exact to rounding.
double kineticEnergy(const JointVector& q, const JointVector& dq) {
  constexpr double h = 1e-30;
  using Complex = std::complex<double>;
  const auto moved = posture<Complex>({Complex(q[0], h * dq[0]), Complex(q[1], h * dq[1])});
  double energy = 0.0;
  for (std::size_t link = 0; link < 2; ++link) {
    const double vx = moved.x[link].imag() / h;
    const double vy = moved.y[link].imag() / h;
    const double turn = moved.turned[link].imag() / h;
    energy += 0.5 * kLeg.mass_kg[link] * (vx * vx + vy * vy) + 0.5 * kLeg.inertia_kg_m2[link] * turn * turn;
  }
  return energy;
}

double potentialEnergy(const JointVector& q) {
  const auto here = posture<double>({q[0], q[1]});
  return kLeg.gravity_m_s2 * (kLeg.mass_kg[0] * here.y[0] + kLeg.mass_kg[1] * here.y[1]);
}

/// ∂²T/∂dq∂dq: T is quadratic in dq, so polarisation is exact.
Eigen::Matrix2d inertia(const JointVector& q) {
  Eigen::Matrix2d result;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const JointVector ei = JointVector::Unit(2, i);
      const JointVector ej = JointVector::Unit(2, j);
      result(i, j) = kineticEnergy(q, ei + ej) - kineticEnergy(q, ei) - kineticEnergy(q, ej);
    }
  }
  return result;
}

template <typename Function>
auto slope(Function function, const JointVector& q, const JointVector& along) {
  constexpr double h = 1e-5;
  const auto after = function(q + h * along);
  const auto before = function(q - h * along);
  return ((after - before) / (2.0 * h));
}

}  // namespace

TEST_CASE("inertia, velocity torque and gravity agree with Lagrange's equations of the masses") {
  const PlanarTwoLink leg(kLeg);
  for (const auto& [q, dq, ddq] : test::randomStates(2)) {
    const Eigen::Matrix2d expected_inertia = inertia(q);
    CHECK((leg.inertia(q) - expected_inertia).cwiseAbs().maxCoeff() < 1e-12);

    // d/dt ∂T/∂dq − ∂T/∂q at ddq = 0, and ∂V/∂q.
    constexpr double h = 1e-5;
    const Eigen::Matrix2d inertia_rate = (inertia(q + h * dq) - inertia(q - h * dq)) / (2.0 * h);
    Eigen::Vector2d velocity_torque = inertia_rate * dq;
    Eigen::Vector2d gravity;
    for (int i = 0; i < 2; ++i) {
      const JointVector unit = JointVector::Unit(2, i);
      const JointVector fixed_rate = dq;
      velocity_torque[i] -=
          slope([&](const JointVector& at) { return kineticEnergy(at, fixed_rate); }, q, unit);
      gravity[i] = slope(potentialEnergy, q, unit);
    }
    CHECK((leg.coriolis(q, dq) * dq - velocity_torque).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((leg.gravity(q) - gravity).cwiseAbs().maxCoeff() < 1e-7);
    CHECK(leg.kineticEnergy(q, dq) == doctest::Approx(kineticEnergy(q, dq)).epsilon(1e-12));
    CHECK(std::abs(leg.potentialEnergy(q) - potentialEnergy(q)) < 1e-12);
  }
}
