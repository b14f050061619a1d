#include "tools/bench/diagnose/inverse_dynamics.hpp"

#include <cmath>

namespace patella::bench {
namespace {

// Of the leg and of single joints.
PerJoint ofFew(const Body& body, const PerJoint& q, const PerJoint& dq, const PerJoint& ddq) {
  if (body.shape == Shape::kPrismatic) {
    return {body.mass_kg[0] * (ddq[0] + body.gravity_m_s2 * std::sin(body.inclination_rad)) +
                body.damping_Nms_rad[0] * dq[0],
            0.0};
  }
  if (body.shape == Shape::kRevolute) {
    return {body.inertia_kg_m2[0] * ddq[0] + body.moment_kg_m * body.gravity_m_s2 * std::cos(q[0]) +
                body.damping_Nms_rad[0] * dq[0],
            0.0};
  }
  // Newton and Euler: accelerations of the centres of mass outwards, forces and moments inwards.
  const double thigh = q[0], shank = q[0] + q[1];
  const double w1 = dq[0], w2 = dq[0] + dq[1];
  const double e1 = ddq[0], e2 = ddq[0] + ddq[1];
  const Pair along1{std::cos(thigh), std::sin(thigh)}, across1{-along1[1], along1[0]};
  const Pair along2{std::cos(shank), std::sin(shank)}, across2{-along2[1], along2[0]};
  Pair force1{}, force2{}, knee_acceleration{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double weight = i == 1 ? body.gravity_m_s2 : 0.0;
    const double turn1 = e1 * across1[i] - w1 * w1 * along1[i];
    const double turn2 = e2 * across2[i] - w2 * w2 * along2[i];
    knee_acceleration[i] = body.length_m[0] * turn1;
    force1[i] = body.mass_kg[0] * (body.com_m[0] * turn1 + weight);
    force2[i] = body.mass_kg[1] * (knee_acceleration[i] + body.com_m[1] * turn2 + weight);
  }
  const auto moment = [](double lever, const Pair& along, const Pair& force) {
    return lever * (along[0] * force[1] - along[1] * force[0]);
  };
  const double knee = body.inertia_kg_m2[1] * e2 + moment(body.com_m[1], along2, force2);
  const double hip = body.inertia_kg_m2[0] * e1 + moment(body.com_m[0], along1, force1) +
                     moment(body.length_m[0], along1, force2) + knee;
  return {hip + body.damping_Nms_rad[0] * dq[0], knee + body.damping_Nms_rad[1] * dq[1]};
}

}  // namespace

InverseDynamics::InverseDynamics(const Body& body) : body_(body) {
  if (body.shape == Shape::kChain) {
    chain_.emplace(body.chain);
  }
}

PerJoint InverseDynamics::operator()(const PerJoint& q, const PerJoint& dq, const PerJoint& ddq) {
  if (!chain_) {
    return ofFew(body_, q, dq, ddq);
  }
  PerJoint torque = chain_->inverseDynamics(q, dq, ddq);
  for (std::size_t j = 0; j < body_.joints(); ++j) {
    torque[j] += body_.damping_Nms_rad[j] * dq[j];
  }
  return torque;
}

Body weightless(Body body) {
  body.gravity_m_s2 = 0.0;
  body.chain.gravity_m_s2.setZero();
  return body;
}

}  // namespace patella::bench
