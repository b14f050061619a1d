// An effect of one's own: an elastic strap of an orthosis, which pulls at the knee beyond the angle where it
// goes taut. A leg with the strap swings; the sampler says what a model without it, and one with it, leaves
// unexplained.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "core/estimation/implicit_sampler.hpp"
#include "core/model/effects/joint_effect.hpp"
#include "core/model/presets.hpp"
#include "sim/plant.hpp"

namespace {

using namespace patella;

class Strap final : public model::JointEffect<2> {
 public:
  Strap(int joint, double stiffness_Nm_rad, double taut_rad)
      : JointEffect(joint, std::array{stiffness_Nm_rad, taut_rad}) {}

  const model::EffectDescriptor& descriptor() const noexcept override {
    static constexpr std::array kParameters{
        model::EffectParameter{"stiffness_Nm_rad", "of the strap, at the joint", 0.0, 100.0, 10.0},
        model::EffectParameter{"taut_rad", "angle beyond which it pulls", -3.2, 3.2, 0.0}};
    static constexpr model::EffectDescriptor kDescriptor{"strap", "tau = -stiffness * max(q - taut, 0)", "",
                                                         kParameters};
    return kDescriptor;
  }

  JointVector torque(const model::EffectInput& input) const noexcept override {
    const double stretch_rad = std::max(input.q[joint()] - parameter(1), 0.0);
    return onJoint(-parameter(0) * stretch_rad, input.q.size());
  }
};

model::DynamicsModel leg(bool with_strap) {
  std::vector<std::unique_ptr<model::Effect>> effects;
  if (with_strap) {
    effects.push_back(std::make_unique<Strap>(1, 20.0, -0.3));
  }
  return {std::make_unique<model::PlanarTwoLink>(model::adultLeg().parameters), std::move(effects)};
}

/// Mean torque at the knee that a model does not explain, N·m, over two seconds of a swinging leg.
double unexplained_Nm(const model::DynamicsModel& known) {
  sim::Plant plant(leg(true), leg(false), {}, 1, {Eigen::Vector2d(-1.4, -0.6), Eigen::Vector2d::Zero()});
  estimation::ImplicitSampler sampler(estimation::SamplerParameters{.delta = 200.0});
  double sum_Nm = 0.0;
  constexpr int kTicks = 2000;
  JointVector torque_Nm = JointVector::Zero(2);
  for (int k = 0; k <= kTicks; ++k) {
    const auto& [q, dq] = plant.state();
    estimation::ObserverInput input{.terms = known.evaluate({.q = q, .dq = dq, .torque_Nm = torque_Nm}),
                                    .q = q,
                                    .dq = dq,
                                    .torque_Nm = torque_Nm,
                                    .dt_s = 1e-3};
    if (k == 0) {
      sampler.reset(input);
    } else {
      sum_Nm += std::abs(sampler.observe(input).d_Nm[1]);
    }
    torque_Nm = Eigen::Vector2d(0.0, 6.0 * std::sin(4.0e-3 * k));
    plant.advance(torque_Nm, {}, 1e-3);
  }
  return sum_Nm / kTicks;
}

}  // namespace

int main() {
  const double without_Nm = unexplained_Nm(leg(false));
  const double with_Nm = unexplained_Nm(leg(true));
  std::printf("unexplained at the knee: %.3f N·m without the strap in the model, %.3f N·m with it\n",
              without_Nm, with_Nm);
  return without_Nm > 0.5 && with_Nm < 0.05 * without_Nm ? 0 : 1;
}
