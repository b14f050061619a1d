#include "tools/bench/diagnose/plant.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "tools/bench/diagnose/constants.hpp"

namespace patella::bench {
namespace {

// Of a tick. A chain's matrices change little in 100 µs, and cost more.
constexpr std::size_t kSteps = 20;
constexpr std::size_t kStepsOfChain = 10;

// On the segment of the joint, which goes to the next joint's origin.
void hangOn(model::SerialChainParameters& chain, std::size_t joint, double mass_kg, double distance_m) {
  const std::size_t at = linkOfJoint(chain, joint);
  addPointMass(chain.links[at], mass_kg, distance_m * chain.links[at + 1].origin_m.normalized());
}

}  // namespace

Plant::Plant(const Body& body, std::span<const TrueEffect> effects, const Surroundings& surroundings,
             const PerJoint& position, const PerJoint& velocity)
    : shape_(body.shape),
      steps_(body.shape == Shape::kChain ? kStepsOfChain : kSteps),
      step_s_(kTick_s / static_cast<double>(steps_)),
      joints_(body.joints()),
      gravity_(body.gravity_m_s2),
      damping_(body.damping_Nms_rad),
      effects_(effects.begin(), effects.end()),
      memory_(effects.size()),
      surroundings_(&surroundings) {
  setBody(body);
  Body loaded = body;
  for (const TrueEffect& effect : effects_) {
    mount(effect, loaded);
  }
  if (shape_ == Shape::kChain) {
    chain_ = std::make_unique<ChainBody>(loaded.chain);
    theta_ = position;
    v_ = v_before_ = velocity;
  } else {
    theta_ = {position[0], position[0] + position[1]};
    v_ = v_before_ = {velocity[0], velocity[0] + velocity[1]};
  }
  for (std::size_t j = 0; j < joints_; ++j) {
    motor_[j].angle = position[j];
    motor_[j].rate = velocity[j];
  }
}

void Plant::setBody(const Body& body) {
  if (shape_ == Shape::kLeg) {
    a_ = body.inertia_kg_m2[0] + body.mass_kg[0] * square(body.com_m[0]) +
         body.mass_kg[1] * square(body.length_m[0]);
    d_ = body.inertia_kg_m2[1] + body.mass_kg[1] * square(body.com_m[1]);
    c_ = body.mass_kg[1] * body.length_m[0] * body.com_m[1];
    w1_ = body.mass_kg[0] * body.com_m[0] + body.mass_kg[1] * body.length_m[0];
    w2_ = body.mass_kg[1] * body.com_m[1];
  } else if (shape_ == Shape::kRevolute) {
    a_ = body.inertia_kg_m2[0];
    w1_ = body.moment_kg_m;
  } else if (shape_ == Shape::kPrismatic) {
    a_ = body.mass_kg[0];
    w1_ = body.mass_kg[0] * std::sin(body.inclination_rad);
  }
}

// Effects that change the machine rather than push it.
void Plant::mount(const TrueEffect& effect, Body& body) {
  const auto& p = effect.p;
  switch (effect.kind) {
    case Kind::kPayload:
      if (shape_ == Shape::kChain) {
        hangOn(body.chain, effect.joint, p[0], p[1]);
      } else if (shape_ == Shape::kPrismatic) {
        a_ += p[0];
        w1_ += p[0] * std::sin(body.inclination_rad);
      } else if (effect.joint == 0) {
        a_ += p[0] * square(p[1]);
        w1_ += p[0] * p[1];
      } else {
        a_ += p[0] * square(body.length_m[0]);
        w1_ += p[0] * body.length_m[0];
        d_ += p[0] * square(p[1]);
        w2_ += p[0] * p[1];
        c_ += p[0] * body.length_m[0] * p[1];
      }
      break;
    case Kind::kRotor:
      rotor_[effect.joint] += p[0];
      break;
    case Kind::kOffset:
      encoder_offset_[effect.joint] += p[0];
      break;
    case Kind::kElasticity:
      motor_[effect.joint] = {.apart = true, .inertia = p[1], .stiffness = p[0], .damping = p[2]};
      break;
    case Kind::kBacklash:
      motor_[effect.joint] = {.apart = true,
                              .inertia = p[3],
                              .stiffness = p[1],
                              .damping = p[2],
                              .half_gap = 0.5 * p[0],
                              .pulls = false};
      break;
    case Kind::kGain:
      drive_[effect.joint].gain += p[0];
      break;
    case Kind::kLag:
      drive_[effect.joint].lag_s += p[0];
      break;
    case Kind::kDelay:
      drive_[effect.joint].delay_s += p[0];
      break;
    default:
      break;
  }
}

void Plant::advance(const PerJoint& command_Nm) {
  for (std::size_t j = 0; j < joints_; ++j) {
    if (drive_[j].commands.empty()) {
      drive_[j].lagged = command_Nm[j];
    }
    drive_[j].commands.push_back(command_Nm[j]);
  }
  for (std::size_t step_in_tick = 0; step_in_tick < steps_; ++step_in_tick) {
    step(step_in_tick);
  }
  ++tick_;
}

PerJoint Plant::toJoints(const PerJoint& segments) const noexcept {
  if (shape_ == Shape::kChain) {
    return segments;
  }
  return {segments[0], segments[1] - segments[0]};
}

double Plant::driveTorque(std::size_t joint, double time_s) {
  Drive& drive = drive_[joint];
  const double place = std::max(0.0, (time_s - drive.delay_s) / kTick_s);
  const double command_Nm =
      drive.commands[std::min(static_cast<std::size_t>(place), drive.commands.size() - 1)];
  if (drive.lag_s > 0.0) {
    drive.lagged += (1.0 - std::exp(-step_s_ / drive.lag_s)) * (command_Nm - drive.lagged);
  } else {
    drive.lagged = command_Nm;
  }
  return drive.gain * drive.lagged;
}

// Moreau's midpoint rule: forces at the middle of the step, friction against the velocity at its end.
void Plant::step(std::size_t step_in_tick) {
  Instant now;
  now.time_s = kTick_s * static_cast<double>(tick_) + step_s_ * (static_cast<double>(step_in_tick) + 0.5);
  PerJoint middle{}, rate{};
  for (std::size_t j = 0; j < joints_; ++j) {
    middle[j] = theta_[j] + 0.5 * step_s_ * v_[j];
    rate[j] = 1.5 * v_[j] - 0.5 * v_before_[j];
  }
  now.q = toJoints(middle);
  now.dq = toJoints(rate);
  Load load;
  for (std::size_t j = 0; j < joints_; ++j) {
    now.drive_Nm[j] = driveTorque(j, now.time_s);
    Motor& motor = motor_[j];
    if (motor.apart) {
      const double angle = motor.angle + 0.5 * step_s_ * motor.rate;
      const double twist = angle - now.q[j];
      const double beyond = std::abs(twist) - motor.half_gap;
      double passed_Nm = 0.0;
      if (motor.pulls || beyond > 0.0) {
        passed_Nm = std::copysign(motor.stiffness * beyond, twist) + motor.damping * (motor.rate - now.dq[j]);
        if (!motor.pulls && passed_Nm * twist < 0.0) {
          passed_Nm = 0.0;
        }
      }
      motor.rate += step_s_ * (now.drive_Nm[j] - passed_Nm) / motor.inertia;
      motor.angle = angle + 0.5 * step_s_ * motor.rate;
      load.torque[j] += passed_Nm;
    } else {
      load.torque[j] += now.drive_Nm[j];
    }
    load.torque[j] += signalAt(surroundings_->human_Nm[j], now.time_s) - damping_[j] * now.dq[j];
    load.inertia[j] += rotor_[j];
  }
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    const TrueEffect& effect = effects_[i];
    const std::size_t j = effect.joint;
    load.torque[j] += softTorque(effect, memory_[i], now);
    const Pair dry = dryFriction(effect, now);
    load.against_forward[j] += dry[0];
    load.against_backward[j] += dry[1];
    if (effect.kind == Kind::kVaryingInertia) {
      load.inertia[j] += effect.p[0] * std::cos(now.q[j]);
    }
  }
  const PerJoint after = solveVelocity(middle, rate, load);
  for (std::size_t j = 0; j < joints_; ++j) {
    theta_[j] = middle[j] + 0.5 * step_s_ * after[j];
  }
  v_before_ = v_;
  v_ = after;
}

PerJoint Plant::solveVelocity(const PerJoint& middle, const PerJoint& rate, const Load& load) const {
  if (chain_) {
    return solveChain(middle, rate, load);
  }
  if (joints_ == 1) {
    const double weight = gravity_ * w1_ * (shape_ == Shape::kRevolute ? std::cos(middle[0]) : 1.0);
    const double inertia = a_ + load.inertia[0];
    const double free_rate = v_[0] + step_s_ * (load.torque[0] - weight) / inertia;
    const double impulse = std::clamp(-free_rate * inertia, -step_s_ * load.against_forward[0],
                                      step_s_ * load.against_backward[0]);
    const double after = free_rate + impulse / inertia;
    return {after, after};
  }
  const double swing = c_ * std::sin(middle[0] - middle[1]);
  const double m11 = a_ + load.inertia[0] + load.inertia[1];
  const double m12 = c_ * std::cos(middle[0] - middle[1]) - load.inertia[1];
  const double m22 = d_ + load.inertia[1];
  const double determinant = m11 * m22 - m12 * m12;
  const double f1 =
      load.torque[0] - load.torque[1] - swing * rate[1] * rate[1] - gravity_ * w1_ * std::cos(middle[0]);
  const double f2 = load.torque[1] + swing * rate[0] * rate[0] - gravity_ * w2_ * std::cos(middle[1]);
  // Inverse of the inertia, h11 … h22; of the joints' rates by impulses in the joints, g11 … g22.
  const double h11 = m22 / determinant, h12 = -m12 / determinant, h22 = m11 / determinant;
  const PerJoint free_rate{v_[0] + step_s_ * (h11 * f1 + h12 * f2), v_[1] + step_s_ * (h12 * f1 + h22 * f2)};
  const double g11 = h11, g12 = h12 - h11, g22 = h11 - 2.0 * h12 + h22;
  const PerJoint joint_rate = toJoints(free_rate);
  PerJoint impulse{};
  // Projected Gauss–Seidel: each joint in turn is stopped, or slides with all its friction.
  constexpr int kSweeps = 50;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const PerJoint before = impulse;
    impulse[0] = std::clamp(-(joint_rate[0] + g12 * impulse[1]) / g11, -step_s_ * load.against_forward[0],
                            step_s_ * load.against_backward[0]);
    impulse[1] = std::clamp(-(joint_rate[1] + g12 * impulse[0]) / g22, -step_s_ * load.against_forward[1],
                            step_s_ * load.against_backward[1]);
    constexpr double kSettled = 1e-13;
    if (std::abs(impulse[0] - before[0]) + std::abs(impulse[1] - before[1]) < kSettled) {
      break;
    }
  }
  const double i1 = impulse[0] - impulse[1];
  const double i2 = impulse[1];
  return {free_rate[0] + h11 * i1 + h12 * i2, free_rate[1] + h12 * i1 + h22 * i2};
}

PerJoint Plant::solveChain(const PerJoint& middle, const PerJoint& rate, const Load& load) const {
  const auto n = static_cast<Eigen::Index>(joints_);
  const auto vectorOf = [n](const PerJoint& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  };
  ChainBody::Terms terms = chain_->terms(middle, rate);
  terms.inertia.diagonal() += vectorOf(load.inertia);
  const JointMatrix mobility = Eigen::LLT<JointMatrix>(terms.inertia).solve(JointMatrix::Identity(n, n));
  JointVector after = vectorOf(v_) + step_s_ * (mobility * (vectorOf(load.torque) - terms.bias_Nm));
  PerJoint impulse{};
  // Projected Gauss–Seidel, as in solveVelocity().
  constexpr int kSweeps = 50;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double moved = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (load.against_forward[at] == 0.0 && load.against_backward[at] == 0.0) {
        continue;
      }
      const double wanted =
          std::clamp(impulse[at] - after[j] / mobility(j, j), -step_s_ * load.against_forward[at],
                     step_s_ * load.against_backward[at]);
      after += mobility.col(j) * (wanted - impulse[at]);
      moved += std::abs(wanted - impulse[at]);
      impulse[at] = wanted;
    }
    constexpr double kSettled = 1e-13;
    if (moved < kSettled) {
      break;
    }
  }
  PerJoint result{};
  std::copy(after.begin(), after.end(), result.begin());
  return result;
}

PerJoint Plant::position() const noexcept {
  return toJoints(theta_);
}

PerJoint Plant::velocity() const noexcept {
  return toJoints(v_);
}

PerJoint Plant::encoder() const noexcept {
  PerJoint angle = position();
  for (std::size_t j = 0; j < joints_; ++j) {
    angle[j] -= encoder_offset_[j];
  }
  return angle;
}

PerJoint Plant::motorPosition() const noexcept {
  PerJoint result = encoder();
  for (std::size_t j = 0; j < joints_; ++j) {
    if (motor_[j].apart) {
      result[j] = motor_[j].angle - encoder_offset_[j];
    }
  }
  return result;
}

double Plant::energy() const {
  if (chain_) {
    return chain_->energy(theta_, v_);
  }
  if (joints_ == 1) {
    const double height = shape_ == Shape::kRevolute ? std::sin(theta_[0]) : theta_[0];
    return 0.5 * (a_ + rotor_[0]) * square(v_[0]) + gravity_ * w1_ * height;
  }
  return 0.5 * (a_ + rotor_[0]) * square(v_[0]) + 0.5 * d_ * square(v_[1]) +
         0.5 * rotor_[1] * square(v_[1] - v_[0]) + c_ * std::cos(theta_[0] - theta_[1]) * v_[0] * v_[1] +
         gravity_ * (w1_ * std::sin(theta_[0]) + w2_ * std::sin(theta_[1]));
}

}  // namespace patella::bench
