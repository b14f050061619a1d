#include "tools/bench/diagnose/plant.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patella::bench {
namespace {

constexpr std::size_t kStepsPerTick = 20;
constexpr double kStep_s = kTick_s / static_cast<double>(kStepsPerTick);
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kTurn = 2.0 * std::numbers::pi;

double square(double value) {
  return value * value;
}

// Riener and Edrich 1999, the ankle at 0, without the stop of the straight knee: N·m that flexes.
double passiveKneeFlexing_Nm(double knee_flexion_deg, double hip_flexion_deg) {
  return std::exp(1.800 - 0.0352 * knee_flexion_deg + 0.0217 * hip_flexion_deg) -
         std::exp(-3.971 + 0.0495 * knee_flexion_deg - 0.0128 * hip_flexion_deg) - 4.820;
}

// Dry friction at this speed, forwards and backwards.
Pair dryFriction(const TrueEffect& effect, double q, double dq, double drive_Nm, double time_s) {
  const auto& p = effect.p;
  switch (effect.kind) {
    case Kind::kCoulomb:
      return {p[0], p[0]};
    case Kind::kAsymmetric:
      return {p[0], p[1]};
    case Kind::kStribeck: {
      const double level = p[0] + p[1] * std::exp(-square(dq / p[2]));
      return {level, level};
    }
    case Kind::kLoadDependent:
      return {p[0] * std::abs(drive_Nm), p[0] * std::abs(drive_Nm)};
    case Kind::kThermal: {
      const double level = p[1] * (1.0 - std::exp(-time_s / p[3]));
      return {level, level};
    }
    case Kind::kRubbingSpot: {
      const double level = p[0] * std::exp(-square((q - p[1]) / p[2]));
      return {level, level};
    }
    case Kind::kDraggingBrake: {
      constexpr double kShareOfTime = 1.0 / 3.0;
      const double place = time_s / p[1];
      const double level = place - std::floor(place) < kShareOfTime ? p[0] : 0.0;
      return {level, level};
    }
    default:
      return {};
  }
}

}  // namespace

Plant::Plant(const Body& body, std::span<const TrueEffect> effects, const Surroundings& surroundings,
             const Pair& position, const Pair& velocity)
    : shape_(body.shape),
      joints_(body.joints()),
      gravity_(body.gravity_m_s2),
      damping_(body.damping_Nms_rad),
      effects_(effects.begin(), effects.end()),
      memory_(effects.size()),
      surroundings_(&surroundings) {
  setBody(body);
  for (const TrueEffect& effect : effects_) {
    mount(effect, body);
  }
  theta_ = {position[0], position[0] + position[1]};
  v_ = v_before_ = {velocity[0], velocity[0] + velocity[1]};
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
  } else {
    a_ = body.mass_kg[0];
    w1_ = body.mass_kg[0] * std::sin(body.inclination_rad);
  }
}

// Effects that change the machine rather than push it.
void Plant::mount(const TrueEffect& effect, const Body& body) {
  const auto& p = effect.p;
  switch (effect.kind) {
    case Kind::kPayload:
      if (shape_ == Shape::kPrismatic) {
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

void Plant::advance(const Pair& command_Nm) {
  for (std::size_t j = 0; j < joints_; ++j) {
    if (drive_[j].commands.empty()) {
      drive_[j].lagged = command_Nm[j];
    }
    drive_[j].commands.push_back(command_Nm[j]);
  }
  for (std::size_t step_in_tick = 0; step_in_tick < kStepsPerTick; ++step_in_tick) {
    step(step_in_tick);
  }
  ++tick_;
}

Pair Plant::toJoints(const Pair& segments) const noexcept {
  return {segments[0], segments[1] - segments[0]};
}

double Plant::signalAt(const std::vector<double>& signal, double time_s) const noexcept {
  if (signal.empty()) {
    return 0.0;
  }
  const double place = std::max(0.0, time_s / kTick_s);
  const auto before = std::min(static_cast<std::size_t>(place), signal.size() - 1);
  const std::size_t after = std::min(before + 1, signal.size() - 1);
  const double share = place - static_cast<double>(before);
  return signal[before] + std::min(share, 1.0) * (signal[after] - signal[before]);
}

double Plant::driveTorque(std::size_t joint, double time_s) {
  Drive& drive = drive_[joint];
  const double place = std::max(0.0, (time_s - drive.delay_s) / kTick_s);
  const double command_Nm =
      drive.commands[std::min(static_cast<std::size_t>(place), drive.commands.size() - 1)];
  if (drive.lag_s > 0.0) {
    drive.lagged += (1.0 - std::exp(-kStep_s / drive.lag_s)) * (command_Nm - drive.lagged);
  } else {
    drive.lagged = command_Nm;
  }
  return drive.gain * drive.lagged;
}

double Plant::humanTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const {
  const auto& p = effect.p;
  const double q = now.q[effect.joint];
  switch (effect.kind) {
    case Kind::kPassiveKnee: {
      // Angles of the joints to flexions; a knee alone belongs to somebody seated.
      const double hip_deg = joints_ == 2 ? 90.0 + kDegrees * now.q[0] : 90.0;
      return -p[0] * passiveKneeFlexing_Nm(-kDegrees * q, hip_deg);
    }
    case Kind::kTremor: {
      const double walk =
          p[3] > 0.0 ? signalAt(surroundings_->phase_walk, now.time_s) / std::sqrt(p[3]) : 0.0;
      return p[0] * std::sin(kTurn * p[1] * now.time_s + p[2] + walk);
    }
    case Kind::kSpasticity: {
      memory.velocity.push_back(now.dq[effect.joint]);
      const auto back = static_cast<std::size_t>(std::lround(p[2] / kStep_s));
      const std::size_t last = memory.velocity.size() - 1;
      return -p[3] * p[0] * std::max(0.0, p[3] * memory.velocity[last - std::min(back, last)] - p[1]);
    }
    case Kind::kEmg:
      return p[0] *
             signalAt(surroundings_->activation[static_cast<std::size_t>(p[1]) - 1], now.time_s - p[2]);
    case Kind::kEmgStiffness:
      return -p[0] * signalAt(surroundings_->activation[static_cast<std::size_t>(p[2]) - 1], now.time_s) *
             (q - p[1]);
    case Kind::kBiarticular:
      return -p[0] * (now.q[1 - effect.joint] - p[1]);
    default:
      return 0.0;
  }
}

double Plant::defectTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const {
  const auto& p = effect.p;
  const double q = now.q[effect.joint];
  const double dq = now.dq[effect.joint];
  const double drive_Nm = now.drive_Nm[effect.joint];
  switch (effect.kind) {
    case Kind::kLoadTakenUp:
      return now.time_s > p[1] ? p[0] : 0.0;
    case Kind::kRelaxingTissue:
      memory.stretch += kStep_s * (dq - memory.stretch / p[1]);
      return -p[0] * memory.stretch;
    case Kind::kEccentricBearing:
      return -p[0] * (1.0 + std::sin(kTurn * p[1] * q + p[2])) * dq;
    case Kind::kSnaggingCable: {
      constexpr double kComesBack = 0.3;
      const double pull = p[0] * std::max(0.0, p[2] * (q - p[1]));
      return -p[2] * pull * (p[2] * dq > 0.0 ? 1.0 : kComesBack);
    }
    case Kind::kWeakeningDrive:
      return -p[0] * drive_Nm * std::min(1.0, std::abs(dq) / p[1]);
    case Kind::kDeadZone:
      return -std::clamp(drive_Nm, -p[0], p[0]);
    case Kind::kDeratingDrive:
      return -p[0] * (1.0 - std::exp(-now.time_s / p[1])) * drive_Nm;
    default:
      return 0.0;
  }
}

double Plant::softTorque(const TrueEffect& effect, Memory& memory, const Instant& now) const {
  const auto& p = effect.p;
  const double q = now.q[effect.joint];
  const double dq = now.dq[effect.joint];
  switch (effect.kind) {
    case Kind::kViscous:
      return -p[0] * dq;
    case Kind::kAsymmetric:
      return -(dq > 0.0 ? p[2] : p[3]) * dq;
    case Kind::kPresliding: {
      const double bristle = (memory.bristle + kStep_s * dq) / (1.0 + kStep_s * p[1] * std::abs(dq) / p[0]);
      const double rate = (bristle - memory.bristle) / kStep_s;
      memory.bristle = bristle;
      return -(p[1] * bristle + p[2] * rate);
    }
    case Kind::kStiffness:
      return -p[0] * (q - p[1]);
    case Kind::kRipple:
      return p[0] * std::sin(kTurn * p[1] * q + p[2]);
    case Kind::kBias:
      return p[0];
    case Kind::kThermal:
      return (1.0 - std::exp(-now.time_s / p[3])) * (p[0] - p[2] * dq);
    case Kind::kCubicDrag:
      return -p[0] * dq * dq * dq;
    case Kind::kVaryingInertia:
      return 0.5 * p[0] * std::sin(q) * dq * dq;
    case Kind::kContact:
      return -p[2] * p[0] * std::max(0.0, p[2] * (q - p[1]));
    case Kind::kVaryingStiffness:
      return -p[0] * (1.0 + std::sin(kTurn * p[2] * now.time_s)) * (q - p[1]);
    case Kind::kHardeningSpring:
      return -p[0] * (q - p[1]) * (q - p[1]) * (q - p[1]);
    default:
      return effect.info().defect ? defectTorque(effect, memory, now) : humanTorque(effect, memory, now);
  }
}

// Moreau's midpoint rule: forces at the middle of the step, friction against the velocity at its end.
void Plant::step(std::size_t step_in_tick) {
  Instant now;
  now.time_s = kTick_s * static_cast<double>(tick_) + kStep_s * (static_cast<double>(step_in_tick) + 0.5);
  const Pair middle{theta_[0] + 0.5 * kStep_s * v_[0], theta_[1] + 0.5 * kStep_s * v_[1]};
  const Pair rate{1.5 * v_[0] - 0.5 * v_before_[0], 1.5 * v_[1] - 0.5 * v_before_[1]};
  now.q = toJoints(middle);
  now.dq = toJoints(rate);
  Load load;
  for (std::size_t j = 0; j < joints_; ++j) {
    now.drive_Nm[j] = driveTorque(j, now.time_s);
    Motor& motor = motor_[j];
    if (motor.apart) {
      const double angle = motor.angle + 0.5 * kStep_s * motor.rate;
      const double twist = angle - now.q[j];
      const double beyond = std::abs(twist) - motor.half_gap;
      double passed_Nm = 0.0;
      if (motor.pulls || beyond > 0.0) {
        passed_Nm = std::copysign(motor.stiffness * beyond, twist) + motor.damping * (motor.rate - now.dq[j]);
        if (!motor.pulls && passed_Nm * twist < 0.0) {
          passed_Nm = 0.0;
        }
      }
      motor.rate += kStep_s * (now.drive_Nm[j] - passed_Nm) / motor.inertia;
      motor.angle = angle + 0.5 * kStep_s * motor.rate;
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
    const Pair dry = dryFriction(effect, now.q[j], now.dq[j], now.drive_Nm[j], now.time_s);
    load.against_forward[j] += dry[0];
    load.against_backward[j] += dry[1];
    if (effect.kind == Kind::kVaryingInertia) {
      load.inertia[j] += effect.p[0] * std::cos(now.q[j]);
    }
  }
  const Pair after = solveVelocity(middle, rate, load);
  theta_ = {middle[0] + 0.5 * kStep_s * after[0], middle[1] + 0.5 * kStep_s * after[1]};
  v_before_ = v_;
  v_ = after;
}

Pair Plant::solveVelocity(const Pair& middle, const Pair& rate, const Load& load) const {
  if (joints_ == 1) {
    const double weight = gravity_ * w1_ * (shape_ == Shape::kRevolute ? std::cos(middle[0]) : 1.0);
    const double inertia = a_ + load.inertia[0];
    const double free_rate = v_[0] + kStep_s * (load.torque[0] - weight) / inertia;
    const double impulse = std::clamp(-free_rate * inertia, -kStep_s * load.against_forward[0],
                                      kStep_s * load.against_backward[0]);
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
  const Pair free_rate{v_[0] + kStep_s * (h11 * f1 + h12 * f2), v_[1] + kStep_s * (h12 * f1 + h22 * f2)};
  const double g11 = h11, g12 = h12 - h11, g22 = h11 - 2.0 * h12 + h22;
  const Pair joint_rate = toJoints(free_rate);
  Pair impulse{};
  // Projected Gauss–Seidel: each joint in turn is stopped, or slides with all its friction.
  constexpr int kSweeps = 50;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Pair before = impulse;
    impulse[0] = std::clamp(-(joint_rate[0] + g12 * impulse[1]) / g11, -kStep_s * load.against_forward[0],
                            kStep_s * load.against_backward[0]);
    impulse[1] = std::clamp(-(joint_rate[1] + g12 * impulse[0]) / g22, -kStep_s * load.against_forward[1],
                            kStep_s * load.against_backward[1]);
    constexpr double kSettled = 1e-13;
    if (std::abs(impulse[0] - before[0]) + std::abs(impulse[1] - before[1]) < kSettled) {
      break;
    }
  }
  const double i1 = impulse[0] - impulse[1];
  const double i2 = impulse[1];
  return {free_rate[0] + h11 * i1 + h12 * i2, free_rate[1] + h12 * i1 + h22 * i2};
}

Pair Plant::position() const noexcept {
  return toJoints(theta_);
}

Pair Plant::velocity() const noexcept {
  return toJoints(v_);
}

Pair Plant::encoder() const noexcept {
  const Pair q = position();
  return {q[0] - encoder_offset_[0], q[1] - encoder_offset_[1]};
}

Pair Plant::motorPosition() const noexcept {
  Pair result = encoder();
  for (std::size_t j = 0; j < joints_; ++j) {
    if (motor_[j].apart) {
      result[j] = motor_[j].angle - encoder_offset_[j];
    }
  }
  return result;
}

double Plant::energy() const noexcept {
  if (joints_ == 1) {
    const double height = shape_ == Shape::kRevolute ? std::sin(theta_[0]) : theta_[0];
    return 0.5 * (a_ + rotor_[0]) * square(v_[0]) + gravity_ * w1_ * height;
  }
  return 0.5 * (a_ + rotor_[0]) * square(v_[0]) + 0.5 * d_ * square(v_[1]) +
         0.5 * rotor_[1] * square(v_[1] - v_[0]) + c_ * std::cos(theta_[0] - theta_[1]) * v_[0] * v_[1] +
         gravity_ * (w1_ * std::sin(theta_[0]) + w2_ * std::sin(theta_[1]));
}

}  // namespace patella::bench
