#include "core/estimation/implicit_sampler.hpp"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "tests/unit/estimation/sampler_run.hpp"

using namespace patella;
using namespace patella::estimation;
using sim::PaperExperiment;

TEST_CASE("the estimate is true to the millirad/s² in both experiments") {
  struct Requirement {
    double rate_Hz, mean, maximum, seconds;
  };
  // Required at 1 kHz; elsewhere the trapezoid's second order makes it fourfold per doubling of the step.
  for (const Requirement& required : {Requirement{500.0, 4e-3, 2e-2, 20.0},
                                      {1000.0, 1e-3, 5e-3, 50.0},
                                      {2000.0, 2.5e-4, 1.25e-3, 20.0},
                                      {10000.0, 1e-5, 5e-5, 5.0}}) {
    for (const PaperExperiment experiment : {PaperExperiment::kFirst, PaperExperiment::kSecond}) {
      CAPTURE(required.rate_Hz);
      const auto samples = runPaperExperiment(experiment, required.rate_Hz, required.seconds, 1);
      ImplicitSampler sampler({});
      const test::Error error = test::errorOf(sampler, samples, 0.1);
      CHECK(error.mean.maxCoeff() <= required.mean);
      CHECK(error.maximum.maxCoeff() <= required.maximum);
      CHECK(sampler.psi().isZero(0.0));
    }
  }
}

TEST_CASE("the requirement does not hang on one torque signal") {
  for (const std::uint64_t seed : {2U, 3U, 4U}) {
    const auto samples = runPaperExperiment(PaperExperiment::kFirst, 1000.0, 20.0, seed);
    ImplicitSampler sampler({});
    const test::Error error = test::errorOf(sampler, samples, 0.1);
    CHECK(error.mean.maxCoeff() <= 1e-3);
    CHECK(error.maximum.maxCoeff() <= 5e-3);
  }
}

TEST_CASE("halving the step quarters the error") {
  ImplicitSampler sampler({});
  const auto coarse =
      test::errorOf(sampler, runPaperExperiment(PaperExperiment::kSecond, 1000.0, 10.0, 1), 0.1);
  const auto fine =
      test::errorOf(sampler, runPaperExperiment(PaperExperiment::kSecond, 2000.0, 10.0, 1), 0.1);
  for (int joint = 0; joint < 2; ++joint) {
    CHECK(coarse.mean[joint] / fine.mean[joint] == doctest::Approx(4.0).epsilon(0.1));
  }
}

TEST_CASE("from psi = 1 psi reaches zero, exactly, after some 15 ms and stays there") {
  struct Case {
    double rate_Hz, earliest_s, latest_s;
  };
  // ln(1 + k_d / delta) / k_d = 15.4 ms for short steps; at k_d dt = 0.3 the implicit step is slower.
  for (const Case& expected : {Case{10000.0, 0.013, 0.016}, {1000.0, 0.015, 0.018}}) {
    const auto samples = runPaperExperiment(PaperExperiment::kFirst, expected.rate_Hz, 0.5, 1);
    const model::DynamicsModel model = makeModel(model::paperLeg());
    ImplicitSampler sampler({});
    sampler.reset(test::observerInput(model, samples.front(), 0.0), JointVector::Ones(2));
    REQUIRE(sampler.psi() == JointVector::Ones(2));
    double not_converged_s = 0.0;
    for (std::size_t k = 1; k < samples.size(); ++k) {
      sampler.update(test::observerInput(model, samples[k], 1.0 / expected.rate_Hz));
      if (!sampler.psi().isZero(0.0)) {
        not_converged_s = samples[k].time_s;
      }
    }
    const double converged_s = not_converged_s + 1.0 / expected.rate_Hz;
    CHECK(converged_s >= expected.earliest_s);
    CHECK(converged_s <= expected.latest_s + 1e-9);
  }
}

TEST_CASE("psi solves the implicit equation to rounding") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-9.0, 4.0);
  for (const auto& [p0, q0] : {std::pair{1, 7}, {3, 5}, {5, 7}, {1, 3}, {9, 11}}) {
    for (int n = 0; n < 200; ++n) {
      const double dt = 1e-3;
      const SamplerParameters parameters{.p0 = p0, .q0 = q0};
      ImplicitSampler sampler(parameters);
      sampler.reset(test::driftInput(JointVector::Zero(1), dt));
      const double excess = std::pow(10.0, exponent(random));
      const double b = -(excess + dt * parameters.delta);
      sampler.update(test::driftInput(JointVector::Constant(1, -b), dt));
      const double x = -sampler.psi()[0];
      REQUIRE(x > 0.0);
      const double left = (1.0 + parameters.k_d * dt) * x +
                          dt * parameters.epsilon * std::pow(x, static_cast<double>(p0) / q0);
      CHECK(left == doctest::Approx(excess).epsilon(1e-6 * std::min(1.0, excess / (excess + 1e-3)) + 1e-12));
    }
  }
}

TEST_CASE("a constant f_u within delta is estimated exactly, one beyond it with a lag of 1/k_d") {
  for (const double f_u : {2.9, -2.9, 30.0, -30.0}) {
    const double dt = 1e-3;
    ImplicitSampler sampler({});
    sampler.reset(test::driftInput(JointVector::Zero(1), dt));
    const auto estimateAfter = [&](int step) {
      return sampler.update(test::driftInput(JointVector::Constant(1, f_u * dt * step), dt))[0];
    };
    const double first = estimateAfter(1);
    if (std::abs(f_u) < 3.0) {
      CHECK(first == doctest::Approx(f_u).epsilon(1e-12));
    } else {
      CHECK(std::abs(first) < 0.5 * std::abs(f_u));
    }
    double last = first;
    for (int step = 2; step <= 40; ++step) {
      last = estimateAfter(step);
    }
    CHECK(last == doctest::Approx(f_u).epsilon(1e-3));
  }
}

TEST_CASE("the sampler is stable for every k_d dt up to 10 and converges no matter how far it starts") {
  for (const double product : {0.01, 0.3, 1.0, 2.0, 5.0, 10.0}) {
    const double dt = 1e-3;
    ImplicitSampler sampler({.k_d = product / dt});
    sampler.reset(test::driftInput(JointVector::Zero(1), dt), JointVector::Constant(1, 50.0));
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0.0, 0.01);
    double velocity = 0.0;
    double last_psi = 50.0;
    for (int n = 1; n <= 20000; ++n) {
      velocity += dt * std::sin(1e-3 * n);
      sampler.update(test::driftInput(JointVector::Constant(1, velocity), dt));
      REQUIRE(std::abs(sampler.psi()[0]) <= std::abs(last_psi));
      last_psi = sampler.psi()[0];
    }
    CHECK(last_psi == 0.0);
    // psi follows noise on velocity without amplifying it.
    for (int n = 1; n <= 2000; ++n) {
      velocity += dt;
      sampler.update(test::driftInput(JointVector::Constant(1, velocity + noise(random)), dt));
      REQUIRE(std::abs(sampler.psi()[0]) < 0.1);
    }
  }
}

TEST_CASE("large steps keep the estimate of the moving leg bounded") {
  // k_d dt from 0.6 to 10 at 1 kHz.
  const auto samples = runPaperExperiment(PaperExperiment::kFirst, 1000.0, 10.0, 1);
  for (const double k_d : {600.0, 2000.0, 5000.0, 10000.0}) {
    ImplicitSampler sampler({.k_d = k_d});
    CHECK(test::errorOf(sampler, samples, 0.1).maximum.maxCoeff() <= 5e-3);
  }
}

TEST_CASE("reset forgets what was before") {
  const auto samples = runPaperExperiment(PaperExperiment::kSecond, 1000.0, 2.0, 1);
  ImplicitSampler used({});
  ImplicitSampler fresh({});
  const model::DynamicsModel model = makeModel(model::paperLeg());
  used.reset(test::driftInput(JointVector::Constant(2, 7.0), 1e-3), JointVector::Constant(2, -4.0));
  used.update(test::driftInput(JointVector::Constant(2, -9.0), 1e-3));
  used.reset(test::observerInput(model, samples[1000], 0.0));
  fresh.reset(test::observerInput(model, samples[1000], 0.0));
  for (std::size_t k = 1001; k < samples.size(); ++k) {
    const auto input = test::observerInput(model, samples[k], 1e-3);
    REQUIRE(used.update(input) == fresh.update(input));
  }
}

TEST_CASE("a NaN shows in the estimate") {
  ImplicitSampler sampler({});
  sampler.reset(test::driftInput(JointVector::Zero(1), 1e-3));
  const JointVector estimate = sampler.update(test::driftInput(JointVector::Constant(1, std::nan("")), 1e-3));
  CHECK(std::isnan(estimate[0]));
}
