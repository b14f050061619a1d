// The tick as a library, in some forty lines: it holds a leg, and finds a push that its model does not know.
#include "core/tick/tick.hpp"

#include <cmath>
#include <cstdio>
#include <memory>

#include "core/estimation/implicit_sampler.hpp"
#include "core/model/presets.hpp"

int main() {
  using namespace patella;
  tick::TickSettings settings;
  settings.emg.bypass = true;
  settings.gains = {.gravity = 1.0,
                    .compensation = 1.0,
                    .stiffness_Nm_rad = JointVector::Constant(2, 60.0),
                    .damping_Nms_rad = JointVector::Constant(2, 6.0)};
  settings.limits.joint.fill({.torque_Nm = 60.0,
                              .torque_rate_Nm_s = 5000.0,
                              .velocity_rad_s = 6.0,
                              .q_min_rad = -2.5,
                              .q_max_rad = 2.5});
  tick::Tick tick(settings, model::makeModel(model::adultLeg()),
                  std::make_unique<estimation::ImplicitSampler>(estimation::SamplerParameters{.delta = 60.0}),
                  nullptr, {}, network::OutputKind::kAcceleration);

  const model::DynamicsModel leg = model::makeModel(model::adultLeg());
  const JointVector push_Nm = Eigen::Vector2d(0.0, 4.0);
  JointVector q = Eigen::Vector2d(-1.4, -0.2), dq = JointVector::Zero(2), torque_Nm = dq, found_Nm = dq;
  tick::TickInput input{.complete = true};
  Measurement& measured = input.measurement;
  measured.has_velocity = true;
  measured.has_drive_torque = true;
  measured.encoder_steps = 1;
  for (int k = 0; k < 2000; ++k, input.time_s += 1e-3) {
    measured.position_rad = q;
    measured.velocity_rad_s = dq;
    measured.operator_enable = k > 100;
    measured.reportDriveTorque(torque_Nm);
    const tick::TickOutput& output = tick.step(input);
    torque_Nm = output.command.torque_Nm;
    found_Nm = output.d_hat_Nm;
    const model::ModelTerms terms = leg.evaluate({.q = q, .dq = dq, .torque_Nm = torque_Nm});
    dq += 1e-3 * (terms.f + terms.inverse_inertia * (torque_Nm + push_Nm));
    q += 1e-3 * dq;
    tick.prepareNext();
  }
  std::printf("push %.2f N·m, found %.2f N·m, torque %.2f N·m\n", push_Nm[1], found_Nm[1], torque_Nm[1]);
  return std::abs(found_Nm[1] - push_Nm[1]) < 0.05 ? 0 : 1;
}
