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

/// The weighted implicit rule, where the law of the contact has corners.
class ContactStep {
 public:
  ContactStep(const TwoMassParameters& parameters, double h_s) noexcept
      : parameters_(parameters),
        h_s_(h_s),
        weighted_s_(kWeight * h_s),
        mobility_(1.0 / parameters.rotor_inertia_kg_m2),
        solve_(1.0 / (1.0 + weighted_s_ * mobility_ *
                                (weighted_s_ * parameters.stiffness_Nm_rad + parameters.damping_Nms_rad))) {}

  TwoMassSide operator()(const TwoMassSide& motor, const TwoMassSide& link, double drive_Nm) const noexcept {
    const double free_rad_s = motor.rate_rad_s + weighted_s_ * mobility_ * drive_Nm;
    const double free_rad = motor.angle_rad + weighted_s_ * free_rad_s;
    const double torque_Nm =
        solve_ * transmittedBy(parameters_, free_rad - link.angle_rad, free_rad_s - link.rate_rad_s);
    return {motor.angle_rad + h_s_ * (free_rad_s - weighted_s_ * mobility_ * torque_Nm),
            motor.rate_rad_s + h_s_ * mobility_ * (drive_Nm - torque_Nm)};
  }

 protected:
  TwoMassParameters parameters_;
  double h_s_;
  double weighted_s_;
  double mobility_;
  double solve_;  ///< share of the free motor's torque that is left once it is held over the step
};

/// The same rule on a spring without play. It is linear in the motor's state, so that one step waits for a
/// product and a sum of the one before only.
class SpringStep : ContactStep {
 public:
  SpringStep(const TwoMassParameters& parameters, double h_s) noexcept
      : ContactStep(parameters, h_s),
        by_angle_Nm_rad_(solve_ * parameters.stiffness_Nm_rad),
        by_rate_Nms_rad_(solve_ * (weighted_s_ * parameters.stiffness_Nm_rad + parameters.damping_Nms_rad)),
        rate_rad_s_Nm_(h_s * mobility_),
        angle_rad_Nm_(weighted_s_ * rate_rad_s_Nm_) {}

  TwoMassSide operator()(const TwoMassSide& motor, const TwoMassSide& link, double drive_Nm) const noexcept {
    const double other_Nm = drive_Nm * (1.0 - by_rate_Nms_rad_ * weighted_s_ * mobility_) +
                            solve_ * (parameters_.stiffness_Nm_rad * link.angle_rad +
                                      parameters_.damping_Nms_rad * link.rate_rad_s);
    return {motor.angle_rad * (1.0 - angle_rad_Nm_ * by_angle_Nm_rad_) +
                motor.rate_rad_s * (h_s_ - angle_rad_Nm_ * by_rate_Nms_rad_) + angle_rad_Nm_ * other_Nm,
            motor.rate_rad_s * (1.0 - rate_rad_s_Nm_ * by_rate_Nms_rad_) -
                motor.angle_rad * (rate_rad_s_Nm_ * by_angle_Nm_rad_) + rate_rad_s_Nm_ * other_Nm};
  }

 private:
  double by_angle_Nm_rad_;  ///< transmitted torque per angle of the motor, …
  double by_rate_Nms_rad_;  ///< … and per rate
  double rate_rad_s_Nm_;    ///< what a torque over the step adds to the motor's rate, …
  double angle_rad_Nm_;     ///< … and to its angle
};

}  // namespace

TwoMass::TwoMass(int joint, const TwoMassParameters& parameters) noexcept
    : joint_(joint),
      parameters_(parameters),
      substep_s_(std::clamp(
          kSubstepAngle_rad * std::sqrt(parameters.rotor_inertia_kg_m2 / parameters.stiffness_Nm_rad),
          kShortestSubstep_s, kLongestSubstep_s)) {}

double TwoMass::torque(const EffectInput& input) const noexcept {
  const double elapsed_s = time_.elapsed_s(input);
  const TwoMassSide motor = elapsed_s > 0.0 ? motorAfter(input, elapsed_s) : motor_;
  const TwoMassSide link = linkOf(input);
  return transmittedBy(parameters_, motor.angle_rad - link.angle_rad, motor.rate_rad_s - link.rate_rad_s) -
         input.torque_Nm[joint_];
}

void TwoMass::advance(const EffectInput& input, double dt_s) noexcept {
  time_.set(input);
  const TwoMassSide link = linkOf(input);
  if (!(dt_s > 0.0) || !std::isfinite(link.angle_rad + link.rate_rad_s + input.torque_Nm[joint_])) {
    return;
  }
  const TwoMassSide motor = motorAfter(input, dt_s);
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

TwoMassSide TwoMass::motorAfter(const EffectInput& input, double dt_s) const noexcept {
  // The small allowance keeps a step from being cut otherwise by rounding.
  const auto substeps = static_cast<int>(std::clamp(std::ceil(dt_s / substep_s_ - 1e-6), 1.0, kMostSubsteps));
  const double h = dt_s / substeps;
  const double drive_to_Nm = input.torque_Nm[joint_];
  const double drive_from_Nm = input.torque_held ? drive_to_Nm : drive_Nm_;

  const TwoMassSide from = link_;
  const TwoMassSide to = linkOf(input);
  const double way_rad = to.angle_rad - from.angle_rad;
  const double start_rad = from.rate_rad_s * dt_s - way_rad;
  const double end_rad = way_rad - to.rate_rad_s * dt_s;
  const double per_substep = 1.0 / substeps;
  const auto follow = [&](auto step) {
    // A copy that stays in registers: the loop is what simulated drives cost.
    TwoMassSide motor = motor_;
    for (int i = 0; i < substeps; ++i) {
      const double s = (i + kWeight) * per_substep;
      const TwoMassSide link{
          from.angle_rad + s * way_rad + s * (1.0 - s) * ((1.0 - s) * start_rad + s * end_rad),
          from.rate_rad_s + s * (to.rate_rad_s - from.rate_rad_s)};
      motor = step(motor, link, drive_from_Nm + s * (drive_to_Nm - drive_from_Nm));
    }
    return motor;
  };
  return parameters_.pulls && parameters_.gap_rad == 0.0 ? follow(SpringStep(parameters_, h))
                                                         : follow(ContactStep(parameters_, h));
}

}  // namespace patella::model
