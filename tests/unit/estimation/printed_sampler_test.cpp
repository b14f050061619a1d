#include "core/estimation/printed_sampler.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "core/estimation/implicit_sampler.hpp"
#include "tests/unit/estimation/sampler_run.hpp"

using namespace patella;
using namespace patella::estimation;
using sim::PaperExperiment;

TEST_CASE("the printed form chatters: a hundred times worse than the implicit one at least") {
  for (const PaperExperiment experiment : {PaperExperiment::kFirst, PaperExperiment::kSecond}) {
    const auto samples = runPaperExperiment(experiment, 1000.0, 20.0, 1);
    PrintedSampler printed({.delta = 0.1});
    ImplicitSampler implicit({});
    const test::Error chatter = test::errorOf(printed, samples, 1.0);
    const test::Error error = test::errorOf(implicit, samples, 1.0);
    for (int joint = 0; joint < 2; ++joint) {
      CHECK(chatter.mean[joint] > 100.0 * error.mean[joint]);
      CHECK(chatter.mean[joint] > 1.0);  // rad/s², as large as f_u itself
    }
  }
}

TEST_CASE("the running mean of the printed form is near f_u") {
  const auto samples = runPaperExperiment(PaperExperiment::kFirst, 10000.0, 5.0, 1);
  const model::DynamicsModel model = makeModel(model::paperLeg());
  PrintedSampler sampler({.delta = 0.1});
  sampler.reset(test::observerInput(model, samples.front(), 0.0));
  Eigen::Vector2d estimate_sum = Eigen::Vector2d::Zero();
  Eigen::Vector2d truth_sum = Eigen::Vector2d::Zero();
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const JointVector estimate = sampler.update(test::observerInput(model, samples[k], 1e-4));
    if (samples[k].time_s > 1.0) {
      estimate_sum += estimate;
      truth_sum += Eigen::Vector2d(samples[k].f_u);
    }
  }
  CHECK((estimate_sum - truth_sum).norm() < 0.02 * truth_sum.norm());
}

TEST_CASE("one step is (22) and (23)") {
  const double dt = 1e-3;
  PrintedSampler sampler({.delta = 0.1});
  ObserverInput input = test::driftInput(JointVector::Zero(1), dt);
  input.terms.f[0] = 2.0;
  sampler.reset(input);
  // psi = 0 at the start, so xi moves by the torque alone: psi = 5 dt − dq.
  input.torque_Nm[0] = 5.0;
  input.dq[0] = 0.25;
  const double psi = 5.0 * dt - 0.25;
  const double rate = -300.0 * psi + 0.1 + 0.55 * std::pow(-psi, 1.0 / 7.0) + 2.0;
  CHECK(sampler.update(input)[0] == doctest::Approx(rate - 2.0).epsilon(1e-12));
  const double next = psi + 0.25 + dt * (rate + 5.0) - 0.25;
  const double sign = next > 0.0 ? 1.0 : -1.0;
  const double next_rate = -300.0 * next - sign * (0.1 + 0.55 * std::pow(std::abs(next), 1.0 / 7.0) + 2.0);
  CHECK(sampler.update(input)[0] == doctest::Approx(next_rate - 2.0).epsilon(1e-12));
}

TEST_CASE("the printed form diverges beyond k_d dt = 2") {
  PrintedSampler sampler({.k_d = 2500.0});
  const double dt = 1e-3;
  sampler.reset(test::driftInput(JointVector::Zero(1), dt));
  double largest = 0.0;
  for (int n = 0; n < 200; ++n) {
    largest = std::abs(sampler.update(test::driftInput(JointVector::Constant(1, 0.01), dt))[0]);
  }
  CHECK(largest > 1e6);
}
