#include "core/model/effects/two_mass.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patella::model {
namespace {

constexpr double kShortestSubstep_s = 25e-6;
constexpr double kLongestSubstep_s = 500e-6;
constexpr double kSubstepAngle_rad = 0.15;
constexpr double kMostSubsteps = 2000.0;
constexpr double kWeight = 0.51;
/// Relative difference of lengths that comes of rounding times.
constexpr double kSameLength = 1e-6;
/// Substeps that a map is not worth working out for.
constexpr int kFewSubsteps = 3;

bool areOneLength(double a_s, double b_s) noexcept {
  return std::abs(a_s - b_s) <= kSameLength * b_s;
}

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

bool isLinear(const TwoMassParameters& parameters) noexcept {
  return parameters.pulls && parameters.gap_rad == 0.0;
}

int substepsOf(double dt_s, double substep_s) noexcept {
  // The small allowance keeps a step from being cut otherwise by rounding.
  return static_cast<int>(std::clamp(std::ceil(dt_s / substep_s - 1e-6), 1.0, kMostSubsteps));
}

std::array<double, 9> inputsOf(const TwoMassSide& motor, const TwoMassCourse& course) noexcept {
  return {motor.angle_rad,   motor.rate_rad_s,       course.way_rad,  course.start_rad,    course.end_rad,
          course.rate_rad_s, course.rate_gain_rad_s, course.drive_Nm, course.drive_gain_Nm};
}

/// The inputs of which number `index` is one and the others are nothing.
std::pair<TwoMassSide, TwoMassCourse> unitInput(std::size_t index) noexcept {
  std::array<double, 9> u{};
  u[index] = 1.0;
  return {{u[0], u[1]},
          {.way_rad = u[2],
           .start_rad = u[3],
           .end_rad = u[4],
           .rate_rad_s = u[5],
           .rate_gain_rad_s = u[6],
           .drive_Nm = u[7],
           .drive_gain_Nm = u[8]}};
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
  learnStep(dt_s);
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
  const TwoMassSide to = linkOf(input);
  const double drive_from_Nm = input.torque_held ? input.torque_Nm[joint_] : drive_Nm_;
  const double way_rad = to.angle_rad - link_.angle_rad;
  const TwoMassCourse course{.way_rad = way_rad,
                             .start_rad = link_.rate_rad_s * dt_s - way_rad,
                             .end_rad = way_rad - to.rate_rad_s * dt_s,
                             .rate_rad_s = link_.rate_rad_s,
                             .rate_gain_rad_s = to.rate_rad_s - link_.rate_rad_s,
                             .drive_Nm = drive_from_Nm,
                             .drive_gain_Nm = input.torque_Nm[joint_] - drive_from_Nm};
  const TwoMassSide from{motor_.angle_rad - link_.angle_rad, motor_.rate_rad_s};
  TwoMassSide motor;
  if (areOneLength(dt_s, learnt_dt_s_)) {
    const std::array<double, kInputs> inputs = inputsOf(from, course);
    for (std::size_t i = 0; i < kInputs; ++i) {
      motor.angle_rad += answers_[i].angle_rad * inputs[i];
      motor.rate_rad_s += answers_[i].rate_rad_s * inputs[i];
    }
  } else {
    motor = stepped(from, course, dt_s);
  }
  return {link_.angle_rad + motor.angle_rad, motor.rate_rad_s};
}

TwoMassSide TwoMass::stepped(const TwoMassSide& from, const TwoMassCourse& course,
                             double dt_s) const noexcept {
  const int substeps = substepsOf(dt_s, substep_s_);
  const double h = dt_s / substeps;
  const double per_substep = 1.0 / substeps;
  const auto follow = [&](auto step) {
    // A copy that stays in registers: the loop is what simulated drives cost.
    TwoMassSide motor = from;
    for (int i = 0; i < substeps; ++i) {
      const double s = (i + kWeight) * per_substep;
      const TwoMassSide link{
          s * course.way_rad + s * (1.0 - s) * ((1.0 - s) * course.start_rad + s * course.end_rad),
          course.rate_rad_s + s * course.rate_gain_rad_s};
      motor = step(motor, link, course.drive_Nm + s * course.drive_gain_Nm);
    }
    return motor;
  };
  return isLinear(parameters_) ? follow(SpringStep(parameters_, h)) : follow(ContactStep(parameters_, h));
}

void TwoMass::learnStep(double dt_s) noexcept {
  // Steps whose length changes all the time cost nothing more than themselves.
  const bool again = areOneLength(dt_s, last_dt_s_);
  last_dt_s_ = dt_s;
  if (!again || areOneLength(dt_s, learnt_dt_s_) || !isLinear(parameters_) ||
      substepsOf(dt_s, substep_s_) <= kFewSubsteps) {
    return;
  }
  for (std::size_t i = 0; i < kInputs; ++i) {
    const auto [motor, course] = unitInput(i);
    answers_[i] = stepped(motor, course, dt_s);
  }
  learnt_dt_s_ = dt_s;
}

}  // namespace patella::model
