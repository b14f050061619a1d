// One tick of model and observers leaves the heap alone. Under a sanitizer, where allocations are
// not counted, Eigen's run-time check stands in.
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include "core/estimation/fixed_lag_smoother.hpp"
#include "core/estimation/printed_sampler.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/presets.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/estimation/observed_leg.hpp"

using namespace patella;
using namespace patella::estimation;

namespace {

/// All effects of the catalogue at their initial values, on every joint.
model::DynamicsModel fullModel(std::unique_ptr<model::Mechanism> mechanism) {
  std::vector<std::unique_ptr<model::Effect>> effects;
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    std::vector<double> initial;
    for (const model::EffectParameter& parameter : descriptor->parameters) {
      initial.push_back(parameter.initial);
    }
    for (int joint = 0; joint < mechanism->joints(); ++joint) {
      effects.push_back(makeEffect(descriptor->kind, joint, *mechanism, initial));
    }
  }
  return {std::move(mechanism), std::move(effects)};
}

/// Allocations of many ticks whose observers start away from convergence.
std::uint64_t allocationsOf(model::DynamicsModel model) {
  const int joints = model.joints();
  ImplicitSampler implicit({});
  PrintedSampler printed({});
  FixedLagSmoother lagged({}, joints, 20);
  std::vector<Observer*> observers{&implicit, &printed, &lagged};
  const std::vector<test::NamedObserver> others = test::allObservers(joints);
  for (const test::NamedObserver& other : others) {
    observers.push_back(other.observer.get());
  }
  VelocityEstimator velocity(40.0);

  const std::uint64_t before = test::allocationCount();
  Eigen::internal::set_is_malloc_allowed(false);
  for (int n = 0; n < 500; ++n) {
    const double time = 1e-3 * n;
    const JointVector q = JointVector::Constant(joints, std::sin(3.0 * time));
    ObserverInput input{.terms = {}, .q = q, .dq = q, .torque_Nm = q, .dt_s = 1e-3};
    input.model = &model;
    input.has_velocity = n < 400;
    if (n == 0) {
      velocity.reset(q);
    }
    input.dq = velocity.update(q, input.dt_s);
    const model::EffectInput at{.q = q, .dq = input.dq, .torque_Nm = input.torque_Nm, .time_s = time};
    if (n == 0) {
      model.reset(at);
    }
    model.advance(at, input.dt_s);
    input.terms = model.evaluate(at);
    input.torque_Nm = model.inverseDynamics(at, q);
    for (Observer* observer : observers) {
      if (n == 0) {
        observer->reset(input);
      }
      observer->update(input);
    }
    if (n == 250) {
      implicit.reset(input, JointVector::Ones(joints));
    }
  }
  Eigen::internal::set_is_malloc_allowed(true);
  return test::allocationCount() - before;
}

}  // namespace

#if !defined(PATELLA_SANITIZER_address) && !defined(PATELLA_SANITIZER_thread) && \
    !defined(PATELLA_SANITIZER_realtime)
TEST_CASE("the count sees what Eigen and new allocate") {
  const std::uint64_t before = test::allocationCount();
  Eigen::VectorXd vector = Eigen::VectorXd::Ones(100);
  CHECK(vector.sum() == 100.0);
  const auto box = std::make_unique<std::array<double, 50>>();
  CHECK(box->size() == 50);
  CHECK(test::allocationCount() >= before + 2);
}
#endif

TEST_CASE("a tick of model and observers does not allocate") {
  CHECK(allocationsOf(fullModel(std::make_unique<model::PlanarTwoLink>(model::paperLeg().parameters))) == 0);
  CHECK(allocationsOf(fullModel(std::make_unique<model::RevoluteJoint>(model::RevoluteJointParameters{
            .inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4}))) == 0);
}
