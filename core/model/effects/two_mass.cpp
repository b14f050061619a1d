#include "core/model/effects/two_mass.hpp"

#include <algorithm>
#include <cmath>

namespace patella::model {
namespace {

constexpr double kShortestSubstep_s = 25e-6;
constexpr double kLongestSubstep_s = 500e-6;
constexpr double kSubstepAngle_rad = 0.15;
constexpr double kMostSubsteps = 2000.0;
constexpr double kWeight = 0.51;

// Torque of the spring, or of the contacts, at this twist and its rate.
inline double transmittedBy(const TwoMassParameters& parameters, double twist_rad,
                            double rate_rad_s) noexcept {
  const double play_rad = 0.5 * parameters.gap_rad;
  const double beyond_rad = twist_rad - std::clamp(twist_rad, -play_rad, play_rad);
  const double torque_Nm = parameters.stiffness_Nm_rad * beyond_rad + parameters.damping_Nms_rad * rate_rad_s;
  if (parameters.pulls) {
    return torque_Nm;
  }
  const double pushed_Nm = beyond_rad < 0.0 ? std::min(torque_Nm, 0.0) : 0.0;
  return beyond_rad > 0.0 ? std::max(torque_Nm, 0.0) : pushed_Nm;
}

}  // namespace

TwoMass::TwoMass(int joint, const TwoMassParameters& parameters) noexcept
    : joint_(joint),
      parameters_(parameters),
      substep_s_(std::clamp(
          kSubstepAngle_rad * std::sqrt(parameters.rotor_inertia_kg_m2 / parameters.stiffness_Nm_rad),
          kShortestSubstep_s, kLongestSubstep_s)) {}

double TwoMass::torque(const EffectInput& input) const noexcept {
  const double elapsed_s = time_.elapsed_s(input);
  const Side motor = elapsed_s > 0.0 ? motorAfter(input, elapsed_s) : motor_;
  const Side link = linkOf(input);
  return transmittedBy(parameters_, motor.angle_rad - link.angle_rad, motor.rate_rad_s - link.rate_rad_s) -
         input.torque_Nm[joint_];
}

void TwoMass::advance(const EffectInput& input, double dt_s) noexcept {
  time_.set(input);
  const Side link = linkOf(input);
  if (!(dt_s > 0.0) || !std::isfinite(link.angle_rad + link.rate_rad_s + input.torque_Nm[joint_])) {
    return;
  }
  const Side motor = motorAfter(input, dt_s);
  if (!std::isfinite(motor.angle_rad + motor.rate_rad_s)) {
    reset(input);
    return;
  }
  motor_ = motor;
  link_ = link;
  drive_Nm_ = input.torque_Nm[joint_];
}

void TwoMass::reset(const EffectInput& input) noexcept {
  time_.set(input);
  const double torque_Nm = input.torque_Nm[joint_];
  const double play_rad = torque_Nm == 0.0 ? 0.0 : std::copysign(0.5 * parameters_.gap_rad, torque_Nm);
  drive_Nm_ = torque_Nm;
  link_ = linkOf(input);
  motor_ = {link_.angle_rad + play_rad + torque_Nm / parameters_.stiffness_Nm_rad, link_.rate_rad_s};
}

TwoMass::Side TwoMass::motorAfter(const EffectInput& input, double dt_s) const noexcept {
  // The small allowance keeps a step from being cut otherwise by rounding.
  const auto substeps = static_cast<int>(std::clamp(std::ceil(dt_s / substep_s_ - 1e-6), 1.0, kMostSubsteps));
  const double h = dt_s / substeps;
  const double weighted = kWeight * h;
  const double mobility = 1.0 / parameters_.rotor_inertia_kg_m2;
  // A torque T held over the substep takes this share of itself off the torque of the free motor.
  const double solve =
      1.0 /
      (1.0 + weighted * mobility * (weighted * parameters_.stiffness_Nm_rad + parameters_.damping_Nms_rad));
  const double drive_to_Nm = input.torque_Nm[joint_];
  const double drive_from_Nm = input.torque_held ? drive_to_Nm : drive_Nm_;

  const Side from = link_;
  const Side to = linkOf(input);
  const double way_rad = to.angle_rad - from.angle_rad;
  const double start_rad = from.rate_rad_s * dt_s - way_rad;
  const double end_rad = way_rad - to.rate_rad_s * dt_s;

  // Copies that stay in registers: the loop is what simulated drives cost.
  const TwoMassParameters parameters = parameters_;
  const double per_substep = 1.0 / substeps;
  Side motor = motor_;
  for (int i = 0; i < substeps; ++i) {
    const double s = (i + kWeight) * per_substep;
    const double link_rad =
        from.angle_rad + s * way_rad + s * (1.0 - s) * ((1.0 - s) * start_rad + s * end_rad);
    const double link_rad_s = from.rate_rad_s + s * (to.rate_rad_s - from.rate_rad_s);
    const double drive_Nm = drive_from_Nm + s * (drive_to_Nm - drive_from_Nm);
    const double free_rad_s = motor.rate_rad_s + weighted * mobility * drive_Nm;
    const double free_rad = motor.angle_rad + weighted * free_rad_s;
    const double torque_Nm = solve * transmittedBy(parameters, free_rad - link_rad, free_rad_s - link_rad_s);
    motor.angle_rad += h * (free_rad_s - weighted * mobility * torque_Nm);
    motor.rate_rad_s += h * mobility * (drive_Nm - torque_Nm);
  }
  return motor;
}

}  // namespace patella::model
