// The Kalman filters against what they must agree with, and in the postures that are hard for them.
#include "core/estimation/kalman_observer.hpp"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "core/model/one_dof.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/unit/estimation/observed_leg.hpp"
#include "tests/unit/model/chains.hpp"

using namespace patella;
using namespace patella::estimation;
using Space = KalmanSettings::Space;
using Disturbance = KalmanSettings::Disturbance;

namespace {

constexpr double kInertia = 0.3;

model::DynamicsModel flywheel() {
  return {std::make_unique<model::RevoluteJoint>(
              model::RevoluteJointParameters{.inertia_kg_m2 = kInertia, .moment_kg_m = 0.0, .length_m = 0.4}),
          {}};
}

KalmanSettings legSettings(Space space, double rest_density_Nm) {
  return {.space = space,
          .position_noise_rad = 1e-4,
          .velocity_noise_rad_s = 1e-3,
          .torque_noise_Nm = 1e-3,
          .disturbance_density = everyJoint(30.0),
          .rest_density_Nm = rest_density_Nm};
}

}  // namespace

TEST_CASE("on a flywheel the covariance settles where the Riccati equation says") {
  // Written out for (q, dq, d) of I ddq = tau + noise + d, both states measured, by plain iteration.
  const double dt = test::kTick_s;
  const KalmanSettings s{.disturbance = Disturbance::kRandomWalk,
                         .position_noise_rad = 2e-4,
                         .velocity_noise_rad_s = 5e-3,
                         .torque_noise_Nm = 0.05,
                         .disturbance_density = everyJoint(2.0)};
  Eigen::Matrix3d f;
  f << 1.0, dt, 0.5 * dt * dt / kInertia, 0.0, 1.0, dt / kInertia, 0.0, 0.0, 1.0;
  const Eigen::Vector3d push(0.5 * dt * dt / kInertia, dt / kInertia, 0.0);
  Eigen::Matrix3d noise = std::pow(s.torque_noise_Nm, 2) * push * push.transpose();
  noise(2, 2) += std::pow(s.disturbance_density[0], 2) * dt;
  Eigen::Matrix<double, 2, 3> h;
  h << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  const Eigen::Matrix2d r =
      Eigen::Vector2d(std::pow(s.position_noise_rad, 2), std::pow(s.velocity_noise_rad_s, 2)).asDiagonal();
  Eigen::Matrix3d p = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 2> gain;
  for (int n = 0; n < 200000; ++n) {
    const Eigen::Matrix3d predicted = f * p * f.transpose() + noise;
    gain = predicted * h.transpose() * (h * predicted * h.transpose() + r).inverse();
    p = (Eigen::Matrix3d::Identity() - gain * h) * predicted;
  }

  const model::DynamicsModel model = flywheel();
  KalmanObserver observer(s, 1);
  test::ObservedLeg leg(model, JointVector::Zero(1));
  observer.reset(leg.sample(JointVector::Zero(1)));
  for (int n = 0; n < 20000; ++n) {
    observer.update(leg.sample(JointVector::Zero(1)));
  }
  const Eigen::Matrix3d settled = observer.covariance();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      CHECK(settled(i, j) == doctest::Approx(p(i, j)).epsilon(1e-6));
    }
  }

  // The gain, too: what a jump of both measurements does to the estimate of d.
  ObserverInput jump = leg.sample(JointVector::Zero(1));
  jump.q[0] += 1e-3;
  jump.dq[0] += 0.1;
  CHECK(kInertia * observer.update(jump)[0] ==
        doctest::Approx(gain(2, 0) * 1e-3 + gain(2, 1) * 0.1).epsilon(1e-6));
}

TEST_CASE("the force at the end point is found, and its torque, in both forms") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  const Eigen::Vector2d force_N(3.0, -2.0);
  for (const Space space : {Space::kForce, Space::kForceAsPrinted}) {
    KalmanObserver observer(legSettings(space, 0.0), 2);
    test::ObservedLeg leg(model, Eigen::Vector2d(-1.2, -0.8));
    observer.reset(leg.sample(JointVector::Zero(2)));
    for (int n = 0; n < 2000; ++n) {
      observer.update(leg.step([&](double, const JointVector& q) {
        const Jacobian j = model.mechanism().jacobian(q);
        return space == Space::kForce ? JointVector(j.transpose() * force_N)
                                      : JointVector(model.mechanism().inertia(q) * (j * force_N));
      }));
    }
    CHECK((observer.state().segment<2>(4) - force_N).norm() < 0.02);
  }
}

TEST_CASE(
    "at the straight knee the force along the leg is unseen, yet its torque is found and nothing grows") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  const Eigen::Vector2d force_N(3.0, -2.0);
  const Eigen::Vector2d straight(-1.0, 0.0);
  const auto pushed = [&](double, const JointVector& q) {
    return JointVector(model.mechanism().jacobian(q).transpose() * force_N);
  };
  for (const double rest : {0.0, 1.0}) {
    const KalmanSettings settings = legSettings(Space::kForce, rest);
    KalmanObserver observer(settings, 2);
    test::ObservedLeg leg(model, straight);
    observer.reset(leg.sample(JointVector::Zero(2)));
    UnknownDynamics estimate;
    for (int n = 0; n < test::unlessSanitized(60000, 10000); ++n) {
      estimate = observer.observe(leg.step(pushed));
      REQUIRE(observer.state().allFinite());
    }
    CHECK((estimate.d_Nm - pushed(0.0, leg.q())).cwiseAbs().maxCoeff() < 0.005);
    CHECK(observer.state().segment<2>(4).norm() < 2.0 * settings.disturbance_limit);
    CHECK(observer.covariance().diagonal().minCoeff() > 0.0);
    const double limit = settings.disturbance_limit * (1.0 + 1e-9);
    CHECK(observer.covariance().block(4, 4, 2, 2).diagonal().maxCoeff() <= limit * limit);

    // Bent, the leg shows the whole force.
    leg.hold(Eigen::Vector2d(-1.0, -0.9));
    for (int n = 0; n < 5000; ++n) {
      estimate = observer.observe(leg.step(pushed));
      REQUIRE(estimate.d_Nm.cwiseAbs().maxCoeff() < 20.0);
    }
    CHECK((estimate.d_Nm - pushed(0.0, leg.q())).cwiseAbs().maxCoeff() < 0.005);
  }
}

TEST_CASE("a push at another point is found where the leg is bent, and at the straight knee with a rest") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  const Eigen::Vector2d force_N(4.0, 1.0);
  const auto pushedAtShin = [&](double, const JointVector& q) {
    const auto motion = model.mechanism().pointMotion(1, 0.08, q, JointVector::Zero(2));
    return JointVector(motion.jacobian.transpose() * force_N);
  };
  struct Case {
    double knee_rad, rest_density_Nm, within_Nm;
  };
  // Straight and without a rest, no force at the end point has this pair of torques: the filter may be wrong
  // by what cannot be explained, and no more.
  for (const Case& expected : {Case{-0.8, 0.0, 0.01}, {-0.8, 1.0, 0.01}, {0.0, 1.0, 0.01}, {0.0, 0.0, 1.5}}) {
    CAPTURE(expected.knee_rad);
    CAPTURE(expected.rest_density_Nm);
    KalmanObserver observer(legSettings(Space::kForce, expected.rest_density_Nm), 2);
    test::ObservedLeg leg(model, Eigen::Vector2d(-1.0, expected.knee_rad));
    observer.reset(leg.sample(JointVector::Zero(2)));
    UnknownDynamics estimate;
    double largest = 0.0;
    for (int n = 0; n < 10000; ++n) {
      estimate = observer.observe(leg.step(pushedAtShin));
      if (n > 500) {
        largest = std::max(largest, estimate.d_Nm.cwiseAbs().maxCoeff());
      }
    }
    CHECK((estimate.d_Nm - pushedAtShin(0.0, leg.q())).cwiseAbs().maxCoeff() < expected.within_Nm);
    CHECK(largest < 3.0);
  }
}

TEST_CASE("noise on the position does not pass through gravity into the estimate") {
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  const auto spread = [&](bool estimate_position) {
    KalmanSettings settings;
    settings.estimate_position = estimate_position;
    settings.position_noise_rad = 0.01;
    settings.velocity_noise_rad_s = 1e-3;
    settings.disturbance_density = everyJoint(0.3);
    KalmanObserver observer(settings, 2);
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0.0, 0.01);
    test::ObservedLeg leg(model, Eigen::Vector2d(-1.2, -0.8));
    observer.reset(leg.sample(JointVector::Zero(2)));
    double sum = 0.0;
    for (int n = 0; n < 8000; ++n) {
      ObserverInput input = leg.step([](double, const JointVector&) { return JointVector::Zero(2).eval(); });
      input.q += Eigen::Vector2d(noise(random), noise(random));
      const JointVector estimate = observer.update(input);
      sum += n < 2000 ? 0.0 : estimate.squaredNorm();
    }
    return std::sqrt(sum / 6000.0);
  };
  CHECK(spread(true) < 0.7 * spread(false));
}

TEST_CASE("an estimate needs a model, and a filter its settings") {
  KalmanObserver observer({}, 2);
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  ObserverInput input = test::ObservedLeg(model, JointVector::Zero(2)).sample(JointVector::Zero(2));
  observer.reset(input);
  CHECK(observer.update(input).allFinite());
  input.model = nullptr;
  CHECK(observer.update(input).array().isNaN().all());

  const auto refuses = [](KalmanSettings settings, int joints, const char* expected) {
    CHECK_THROWS_WITH_AS(KalmanObserver(settings, joints), doctest::Contains(expected),
                         std::invalid_argument);
  };
  refuses({.position_noise_rad = 0.0}, 2, "position_noise_rad = 0");
  refuses({.velocity_noise_rad_s = -1.0}, 2, "velocity_noise_rad_s = -1");
  refuses({.torque_noise_Nm = std::nan("")}, 2, "torque_noise_Nm = nan");
  refuses({.disturbance_density = {1.0, 0.0}}, 2, "disturbance_density[2] = 0");
  refuses({.disturbance_limit = 0.0}, 2, "disturbance_limit = 0");
  refuses({.rest_density_Nm = -1.0}, 2, "rest_density_Nm = -1");
  refuses({.space = Space::kForceAsPrinted}, 1, "joints of a force as printed = 1");
  refuses({}, 9, "joints = 9");
}

TEST_CASE("a force in the leg's plane is not sought on a mechanism in space: the estimate is NaN") {
  const model::PlanarTwoLinkParameters leg = model::physicalLeg().parameters;
  const model::DynamicsModel chain(std::make_unique<model::SerialChain>(test::asChain(leg)), {});
  for (const auto space : {Space::kForce, Space::kJointTorque}) {
    KalmanObserver observer({.space = space}, 2);
    const ObserverInput input = test::ObservedLeg(chain, JointVector::Zero(2)).sample(JointVector::Zero(2));
    observer.reset(input);
    CHECK(observer.update(input).array().isNaN().any() == (space == Space::kForce));
  }
}
