// The time in which psi reaches zero, against the bound of convergence_bound.hpp and the one that (19)
// prints.
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "core/estimation/convergence_bound.hpp"
#include "core/estimation/implicit_sampler.hpp"
#include "tests/unit/estimation/sampler_run.hpp"

using namespace patella;
using namespace patella::estimation;

namespace {

constexpr SamplerParameters kPaper{.delta = 0.1};

/// (19), for which the paper divides by a instead of a (1 − c).
double printedBound(const SamplerParameters& parameters, const JointVector& psi) {
  const double c = static_cast<double>(parameters.p0 + parameters.q0) / (2.0 * parameters.q0);
  return convergenceTimeBound(parameters, psi) * (1.0 - c);
}

/// Time to zero of (24) in the worst case that its conditions allow, where f_u cancels delta and f cancels
/// |f|: psi' = −k_d psi − epsilon psi^{p/q}. In z = psi^{1 − p/q} this is smooth through zero: z' = −(1 −
/// p/q)(k_d z + epsilon). Midpoint rule.
double worstTime(const SamplerParameters& parameters, double psi) {
  const double share = 1.0 - static_cast<double>(parameters.p0) / parameters.q0;
  const auto rate = [&](double z) { return -share * (parameters.k_d * z + parameters.epsilon); };
  constexpr double h = 1e-7;
  double z = std::pow(psi, share);
  double time = 0.0;
  while (z > 0.0) {
    z += h * rate(z + h / 2.0 * rate(z));
    time += h;
  }
  return time;
}

/// Time to exact zero of the implicit sampler while f_u acts with its largest magnitude against convergence,
/// each joint for itself.
double sampledTime(const SamplerParameters& parameters, const JointVector& psi, double f_u, double dt) {
  ImplicitSampler sampler(parameters);
  sampler.reset(test::driftInput(JointVector::Zero(psi.size()), dt), psi);
  for (int k = 1; k * dt < 1.0; ++k) {
    // psi' contains −f_u, which holds psi up where f_u is negative.
    sampler.update(test::driftInput(JointVector::Constant(psi.size(), -f_u * k * dt), dt));
    if (sampler.psi().cwiseAbs().maxCoeff() < 1e-12) {
      return k * dt;
    }
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

TEST_CASE("from psi = 1 the paper's gains take 24.51 ms; its bound of 10.51 ms is exceeded") {
  const JointVector one = JointVector::Ones(1);
  CHECK(convergenceTimeBound(kPaper, one) == doctest::Approx(24.51e-3).epsilon(1e-3));
  CHECK(printedBound(kPaper, one) == doctest::Approx(10.51e-3).epsilon(1e-3));
  const double time = worstTime(kPaper, 1.0);
  CHECK(time > 2.0 * printedBound(kPaper, one));
  // For one joint the bound is the exact time.
  CHECK(time == doctest::Approx(convergenceTimeBound(kPaper, one)).epsilon(1e-4));
}

TEST_CASE("the bound holds with equality for one joint, whatever the gains") {
  for (const SamplerParameters& parameters :
       {SamplerParameters{.k_d = 30.0}, {.epsilon = 5.0}, {.p0 = 3, .q0 = 5}, {.p0 = 5, .q0 = 7}}) {
    for (const double psi : {0.01, 0.3, 10.0}) {
      CHECK(worstTime(parameters, psi) ==
            doctest::Approx(convergenceTimeBound(parameters, JointVector::Constant(1, psi))).epsilon(1e-3));
    }
  }
}

TEST_CASE("for two joints the bound on both together covers the slower one") {
  for (const Eigen::Vector2d& psi : {Eigen::Vector2d(1.0, 1.0), {1.0, -0.2}, {0.01, 3.0}}) {
    const double slower = worstTime(kPaper, psi.cwiseAbs().maxCoeff());
    CHECK(slower <= convergenceTimeBound(kPaper, psi) * (1.0 + 1e-4));
    CHECK(slower > printedBound(kPaper, psi));
  }
}

TEST_CASE("the implicit sampler converges within the bound as steps become short") {
  constexpr double dt = 1e-5;
  for (const Eigen::Vector2d& psi : {Eigen::Vector2d(1.0, 1.0), {1.0, 0.2}, {0.05, 0.01}}) {
    const double bound = convergenceTimeBound(kPaper, psi);
    // The largest f_u that delta covers, against convergence: the implicit step adds k_d dt / 2 of relative
    // time.
    CHECK(sampledTime(kPaper, psi, kPaper.delta, dt) <= bound * (1.0 + kPaper.k_d * dt));
    CHECK(sampledTime(kPaper, psi, 0.0, dt) < bound);
  }
  CHECK(sampledTime(kPaper, JointVector::Ones(1), kPaper.delta, dt) >
        printedBound(kPaper, JointVector::Ones(1)));
}

TEST_CASE("at 1 kHz with delta above f_u, convergence comes well within the bound") {
  const SamplerParameters parameters{};
  CHECK(sampledTime(parameters, JointVector::Ones(2), 0.0, 1e-3) <
        convergenceTimeBound(parameters, JointVector::Ones(2)));
}
