// A knee to plan motions for.
#pragma once

#include "tools/diagnose/plan/motion_plan.hpp"

namespace patella::test {

inline diagnose::PlanRequest kneeRequest() {
  diagnose::PlanRequest request;
  request.model.mechanism =
      model::RevoluteJointParameters{.inertia_kg_m2 = 0.35, .moment_kg_m = 1.0, .length_m = 0.4};
  request.limits.joint[0] = {.torque_Nm = 30.0,
                             .torque_rate_Nm_s = 1e4,
                             .velocity_rad_s = 4.0,
                             .q_min_rad = -2.0,
                             .q_max_rad = 0.2,
                             .soft_margin_rad = 0.05};
  request.start_rad = JointVector::Constant(1, -0.9);
  request.effects = {"linear_stiffness"};
  request.noise = {{.noise_Nm = 0.1, .structure_Nm = 0.0}};
  request.timing.duration_s = 12.0;
  request.design.evaluations = 300;
  return request;
}

}  // namespace patella::test
