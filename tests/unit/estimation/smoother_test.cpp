// Smoothers against Gaussian conditioning on everything at once, and against each other.
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "core/estimation/fixed_lag_smoother.hpp"
#include "core/estimation/state_smoother.hpp"
#include "core/model/one_dof.hpp"
#include "tests/unit/estimation/observed_leg.hpp"

using namespace patella;
using namespace patella::estimation;
using Disturbance = KalmanSettings::Disturbance;

namespace {

constexpr double kInertia = 0.3;

const KalmanSettings kSettings{.disturbance = Disturbance::kRandomWalk,
                               .position_noise_rad = 2e-3,
                               .velocity_noise_rad_s = 0.02,
                               .torque_noise_Nm = 0.05,
                               .disturbance_density = everyJoint(5.0),
                               .disturbance_limit = 3.0};

model::DynamicsModel flywheel() {
  return {std::make_unique<model::RevoluteJoint>(
              model::RevoluteJointParameters{.inertia_kg_m2 = kInertia, .moment_kg_m = 0.0, .length_m = 0.4}),
          {}};
}

/// Noisy samples of a leg under a torque of 1.5 Hz; the truth, rad/s², beside them.
struct Recorded {
  std::vector<ObserverInput> samples;
  std::vector<JointVector> truth;
};

Recorded record(const model::DynamicsModel& model, const JointVector& start, int count) {
  std::mt19937 random(8);
  std::normal_distribution<double> unit;
  test::ObservedLeg leg(model, start);
  Recorded recorded;
  const auto unknown = [&](double t, const JointVector& q) {
    return JointVector::Constant(q.size(), 0.5 * std::sin(9.4 * t)).eval();
  };
  for (int n = 0; n < count; ++n) {
    ObserverInput input = n == 0 ? leg.sample(JointVector::Zero(start.size())) : leg.step(unknown);
    recorded.truth.push_back(input.terms.inverse_inertia * unknown(leg.time_s(), leg.q()));
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      input.q[i] += kSettings.position_noise_rad * unit(random);
      input.dq[i] += kSettings.velocity_noise_rad_s * unit(random);
    }
    recorded.samples.push_back(input);
  }
  return recorded;
}

double rms(const std::vector<UnknownDynamics>& estimates, const Recorded& recorded, std::size_t from) {
  double sum = 0.0;
  for (std::size_t k = from; k + from < estimates.size(); ++k) {
    sum += (estimates[k].f_u - recorded.truth[k]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(estimates.size() - 2 * from));
}

/// E[d_k | all measurements] of (q, dq, d), from the joint covariance of all states of all samples.
Eigen::VectorXd conditioned(const std::vector<ObserverInput>& samples) {
  const double dt = test::kTick_s;
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::Matrix3d f;
  f << 1.0, dt, 0.5 * dt * dt / kInertia, 0.0, 1.0, dt / kInertia, 0.0, 0.0, 1.0;
  const Eigen::Vector3d push(0.5 * dt * dt / kInertia, dt / kInertia, 0.0);
  Eigen::Matrix3d noise = std::pow(kSettings.torque_noise_Nm, 2) * push * push.transpose();
  noise(2, 2) += std::pow(kSettings.disturbance_density[0], 2) * dt;

  Eigen::VectorXd mean(3 * n);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  mean.head(3) << samples[0].q[0], samples[0].dq[0], 0.0;
  const Eigen::Vector3d start(kSettings.position_noise_rad, kSettings.velocity_noise_rad_s,
                              0.5 * kSettings.disturbance_limit);
  covariance.topLeftCorner(3, 3) = start.cwiseAbs2().asDiagonal();
  for (Eigen::Index k = 1; k < n; ++k) {
    mean.segment(3 * k, 3) =
        f * mean.segment(3 * k - 3, 3) + push * samples[static_cast<std::size_t>(k)].torque_Nm[0];
    covariance.block(3 * k, 0, 3, 3 * k) = f * covariance.block(3 * k - 3, 0, 3, 3 * k);
    covariance.block(0, 3 * k, 3 * k, 3) = covariance.block(3 * k, 0, 3, 3 * k).transpose();
    covariance.block(3 * k, 3 * k, 3, 3) =
        f * covariance.block(3 * k - 3, 3 * k - 3, 3, 3) * f.transpose() + noise;
  }
  // The first sample is the start; the others are measured.
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(2 * (n - 1), 3 * n);
  Eigen::VectorXd z(2 * (n - 1));
  Eigen::VectorXd r(2 * (n - 1));
  for (Eigen::Index k = 1; k < n; ++k) {
    h(2 * k - 2, 3 * k) = h(2 * k - 1, 3 * k + 1) = 1.0;
    z.segment(2 * k - 2, 2) << samples[static_cast<std::size_t>(k)].q[0],
        samples[static_cast<std::size_t>(k)].dq[0];
    r.segment(2 * k - 2, 2) << std::pow(kSettings.position_noise_rad, 2),
        std::pow(kSettings.velocity_noise_rad_s, 2);
  }
  Eigen::MatrixXd s = h * covariance * h.transpose();
  s.diagonal() += r;
  const Eigen::VectorXd all = mean + covariance * h.transpose() * s.ldlt().solve(z - h * mean);
  Eigen::VectorXd d(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    d[k] = all[3 * k + 2];
  }
  return d;
}

}  // namespace

TEST_CASE("the smoother gives the mean conditioned on all measurements") {
  const model::DynamicsModel model = flywheel();
  const Recorded recorded = record(model, JointVector::Zero(1), 120);
  const auto smoothed = smoothUnknownDynamics(kSettings, recorded.samples);
  const Eigen::VectorXd expected = conditioned(recorded.samples);
  for (std::size_t k = 0; k < smoothed.size(); ++k) {
    CHECK(smoothed[k].d_Nm[0] == doctest::Approx(expected[static_cast<Eigen::Index>(k)]).epsilon(1e-6));
  }
}

TEST_CASE("a fixed lag gives what the smoother gives on the samples so far") {
  constexpr int kLag = 25;
  const model::DynamicsModel model = flywheel();
  const Recorded recorded = record(model, JointVector::Zero(1), 120);
  FixedLagSmoother lagged(kSettings, 1, kLag);
  lagged.reset(recorded.samples[0]);
  for (std::size_t k = 1; k < recorded.samples.size(); ++k) {
    const double estimate = lagged.update(recorded.samples[k])[0];
    if (k > kLag && k % 10 == 0) {
      const auto so_far = std::span(recorded.samples).first(k + 1);
      CHECK(estimate ==
            doctest::Approx(smoothUnknownDynamics(kSettings, so_far)[k - kLag].f_u[0]).epsilon(1e-6));
    }
  }
}

TEST_CASE("on the leg hindsight helps, all of it the most") {
  constexpr int kLag = 60;
  const model::DynamicsModel model = makeModel(model::physicalLeg());
  const Recorded recorded = record(model, Eigen::Vector2d(-1.2, -0.8), 4000);
  KalmanSettings settings = kSettings;
  settings.disturbance = Disturbance::kConstantRate;
  settings.disturbance_density = everyJoint(20.0);
  KalmanObserver filter(settings, 2);
  FixedLagSmoother lagged(settings, 2, kLag);
  filter.reset(recorded.samples[0]);
  lagged.reset(recorded.samples[0]);
  std::vector<UnknownDynamics> filtered(1, {JointVector::Zero(2), JointVector::Zero(2)});
  std::vector<UnknownDynamics> with_lag;
  for (std::size_t k = 1; k < recorded.samples.size(); ++k) {
    filtered.push_back(filter.observe(recorded.samples[k]));
    const UnknownDynamics past = lagged.observe(recorded.samples[k]);
    if (k > kLag) {
      with_lag.push_back(past);
    }
  }
  Recorded lagged_truth = recorded;
  lagged_truth.truth.erase(lagged_truth.truth.begin());  // the first estimate is of sample 1
  const double causal = rms(filtered, recorded, 500);
  const double some = rms(with_lag, lagged_truth, 500);
  const double all = rms(smoothUnknownDynamics(settings, recorded.samples), recorded, 500);
  CHECK(some < 0.8 * causal);
  CHECK(all < 1.02 * some);
}

TEST_CASE("smoothers refuse what they cannot use") {
  CHECK_THROWS_WITH_AS(FixedLagSmoother({}, 2, 0), doctest::Contains("lag_steps = 0"), std::invalid_argument);
  CHECK_THROWS_AS(FixedLagSmoother({.estimate_position = false}, 2, 10), std::invalid_argument);
  CHECK_THROWS_AS(smoothUnknownDynamics({.estimate_position = false}, {}), std::invalid_argument);
  CHECK(smoothUnknownDynamics({}, {}).empty());
  const model::DynamicsModel model = flywheel();
  Recorded recorded = record(model, JointVector::Zero(1), 5);
  recorded.samples[3].model = nullptr;
  CHECK_THROWS_WITH_AS(smoothUnknownDynamics(kSettings, recorded.samples), doctest::Contains("no model"),
                       std::invalid_argument);
}
