#include "core/estimation/kalman_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bounds/bounds.hpp"
#include "core/check.hpp"

namespace patella::estimation {
namespace {

using Space = KalmanSettings::Space;

constexpr double kRatePerSecond = 10.0;  // bound of the rate of w over that of w
constexpr double kStartShare = 0.5;      // of the bounds, standard deviation at the start
constexpr double kDerivedVelocity_rad_s =
    1.0;  // how far a velocity that was not measured may be off at the start
constexpr double kSmallestTurn_rad = 1e-4;  // of the differences
constexpr double kSmallestSpeed_rad_s = 1e-3;
// A linear step holds up to this change of ddq; friction near standstill exceeds it.
constexpr double kLargestSlopeStep = 0.5;

KalmanLayout layoutOf(const KalmanSettings& settings, int joints) {
  requireRange("joints", joints, 1, kMaxJoints);
  if (settings.space == Space::kForceAsPrinted) {
    requireRange("joints of a force as printed", joints, 2, 2);
  }
  KalmanLayout layout;
  layout.joints = joints;
  const bool of_joints = settings.space == Space::kJointTorque || settings.space == Space::kAcceleration;
  layout.unknowns = of_joints ? joints : 2;
  layout.rates = settings.disturbance == KalmanSettings::Disturbance::kConstantRate ? layout.unknowns : 0;
  layout.rest = !of_joints && settings.rest_density_Nm > 0.0 ? joints : 0;
  return layout;
}

double squared(double x) noexcept {
  return x * x;
}

}  // namespace

const KalmanSettings& checked(const KalmanSettings& settings) {
  requireBound(boundOf("estimation.position_noise_rad"), settings.position_noise_rad);
  requireBound(boundOf("estimation.velocity_noise_rad_s"), settings.velocity_noise_rad_s);
  requireBound(boundOf("estimation.torque_noise_Nm"), settings.torque_noise_Nm);
  requireBound(boundOf("estimation.disturbance_density"), settings.disturbance_density);
  requireBound(boundOf("estimation.disturbance_limit"), settings.disturbance_limit);
  requireBound(boundOf("estimation.rest_density_Nm"), settings.rest_density_Nm);
  return settings;
}

KalmanObserver::KalmanObserver(const KalmanSettings& settings, int joints)
    : settings_(checked(settings)), layout_(layoutOf(settings, joints)) {
  transition_.layout = layout_;
}

void KalmanObserver::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const int n = layout_.joints;
  state_.setZero(layout_.states());
  state_.head(n) = input.q;
  state_.segment(n, n) = input.dq;
  KalmanVector deviation =
      KalmanVector::Constant(layout_.states(), kStartShare * settings_.disturbance_limit);
  deviation.head(n).setConstant(settings_.estimate_position ? settings_.position_noise_rad : 0.0);
  deviation.segment(n, n).setConstant(input.has_velocity ? settings_.velocity_noise_rad_s
                                                         : kDerivedVelocity_rad_s);
  deviation.segment(layout_.rate(), layout_.rates) *= kRatePerSecond;
  covariance_ = KalmanMatrix::Zero(layout_.states(), layout_.states());
  covariance_.diagonal() = deviation.cwiseAbs2();
  correction_count_ = 0;
  linearise(input);
}

JointVector KalmanObserver::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  if (input.model == nullptr) {
    return JointVector::Constant(layout_.joints, std::numeric_limits<double>::quiet_NaN());
  }
  predict(input);
  predicted_state_ = state_;
  predicted_covariance_ = covariance_;
  correct(input);
  linearise(input);
  return map_.lazyProduct(state_);
}

JointVector KalmanObserver::unknownDynamics(const KalmanVector& state,
                                            const ObserverInput& input) const noexcept {
  return motionAt(state, input).map.lazyProduct(state);
}

KalmanObserver::Motion KalmanObserver::motionAt(const KalmanVector& state,
                                                const ObserverInput& input) const noexcept {
  const int n = layout_.joints;
  const JointVector q = state.head(n);
  Motion motion;
  motion.terms = input.model->evaluate({.q = q,
                                        .dq = state.segment(n, n),
                                        .torque_Nm = input.torque_Nm,
                                        .activation = input.activation,
                                        .time_s = input.time_s});
  motion.map.setZero(n, layout_.states());
  auto map = motion.map.middleCols(layout_.w(), layout_.unknowns);
  if (forceless(*input.model)) {
    map.setConstant(std::numeric_limits<double>::quiet_NaN());
    return motion;
  }
  switch (settings_.space) {
    case Space::kJointTorque:
      map = motion.terms.inverse_inertia;
      break;
    case Space::kAcceleration:
      map.setIdentity();
      break;
    case Space::kForce:
      map = motion.terms.inverse_inertia.lazyProduct(input.model->mechanism().jacobian(q).transpose());
      break;
    case Space::kForceAsPrinted:
      map = input.model->mechanism().jacobian(q);
      break;
  }
  if (layout_.rest > 0) {
    motion.map.middleCols(layout_.restBegin(), layout_.rest) = motion.terms.inverse_inertia;
  }
  return motion;
}

bool KalmanObserver::forceless(const model::DynamicsModel& dynamics) const noexcept {
  const bool of_force = settings_.space == Space::kForce || settings_.space == Space::kForceAsPrinted;
  return of_force && dynamics.mechanism().dimensions() != layout_.unknowns;
}

JointVector KalmanObserver::accelerationOf(const Motion& motion, const KalmanVector& state,
                                           const JointVector& torque_Nm) const noexcept {
  return motion.terms.f + motion.terms.inverse_inertia.lazyProduct(torque_Nm) + motion.map.lazyProduct(state);
}

void KalmanObserver::predict(const ObserverInput& input) noexcept {
  const int n = layout_.joints;
  const double dt = input.dt_s;
  const JointVector dq = state_.segment(n, n);
  const JointVector begin = accelerationOf(motion_, state_, input.torque_Nm);
  state_.head(n) += dt * dq + 0.5 * dt * dt * begin;
  state_.segment(n, n) += dt * begin;
  if (layout_.rates > 0) {
    state_.segment(layout_.w(), layout_.unknowns) += dt * state_.segment(layout_.rate(), layout_.rates);
  }
  const JointVector end = accelerationOf(motionAt(state_, input), state_, input.torque_Nm);
  state_.head(n) += 0.25 * dt * dt * (end - begin);
  state_.segment(n, n) += 0.5 * dt * (end - begin);

  transition_.dt_s = dt;
  transition_.acceleration = slope_;
  const double steepest = kLargestSlopeStep / dt;
  auto by_velocity = transition_.acceleration.middleCols(n, n);
  by_velocity = by_velocity.cwiseMax(-steepest).cwiseMin(steepest).eval();
  transition_.apply(covariance_);
  covariance_.transposeInPlace();
  transition_.apply(covariance_);
  addProcessNoise(input);
  const KalmanMatrix transposed = covariance_.transpose();
  covariance_ = 0.5 * (covariance_ + transposed);
}

void KalmanObserver::addProcessNoise(const ObserverInput& input) noexcept {
  const int n = layout_.joints;
  const double dt = input.dt_s;
  const JointMatrix inverse = motion_.terms.inverse_inertia;
  const JointMatrix of_velocity = squared(settings_.torque_noise_Nm * dt) * inverse.lazyProduct(inverse);
  covariance_.block(0, 0, n, n) += 0.25 * dt * dt * of_velocity;
  covariance_.block(0, n, n, n) += 0.5 * dt * of_velocity;
  covariance_.block(n, 0, n, n) += 0.5 * dt * of_velocity;
  covariance_.block(n, n, n, n) += of_velocity;
  for (int i = 0; i < layout_.unknowns; ++i) {
    const int w = layout_.w() + i;
    const double drive = squared(settings_.disturbance_density[static_cast<std::size_t>(i)]) * dt;
    if (layout_.rates == 0) {
      covariance_(w, w) += drive;
      continue;
    }
    const int rate = layout_.rate() + i;
    covariance_(w, w) += dt * dt / 3.0 * drive;
    covariance_(w, rate) += 0.5 * dt * drive;
    covariance_(rate, w) += 0.5 * dt * drive;
    covariance_(rate, rate) += drive;
  }
  for (int i = layout_.restBegin(); i < layout_.states(); ++i) {
    covariance_(i, i) += squared(settings_.rest_density_Nm) * dt;
  }
}

// A state that no measurement shows would drift for ever, as would its uncertainty. Where that exceeds its
// bound, the bound is taken for a measurement: nought, with the noise that brings the variance back to the
// bound.
void KalmanObserver::boundUnseen() noexcept {
  for (int i = layout_.w(); i < layout_.states(); ++i) {
    const bool is_rate = i >= layout_.rate() && i < layout_.restBegin();
    const double bound = squared(settings_.disturbance_limit * (is_rate ? kRatePerSecond : 1.0));
    const double variance = covariance_(i, i);
    if (variance > bound) {
      correct(i, 0.0, std::sqrt(variance * bound / (variance - bound)));
    }
  }
}

void KalmanObserver::correct(const ObserverInput& input) noexcept {
  const int n = layout_.joints;
  correction_count_ = 0;
  if (settings_.estimate_position || !input.has_velocity) {
    for (int joint = 0; joint < n; ++joint) {
      correct(joint, input.q[joint], settings_.position_noise_rad);
    }
  } else {
    takePositionAsKnown(input);
  }
  if (input.has_velocity) {
    for (int joint = 0; joint < n; ++joint) {
      correct(n + joint, input.dq[joint], settings_.velocity_noise_rad_s);
    }
  }
  boundUnseen();
}

void KalmanObserver::correct(int state, double measured, double noise) noexcept {
  KalmanCorrection& c = corrections_[correction_count_++];
  c.state = state;
  c.innovation = measured - state_[state];
  c.variance = covariance_(state, state) + squared(noise);
  c.gain = covariance_.col(state) / c.variance;
  state_ += c.innovation * c.gain;
  covariance_ -= c.variance * c.gain.lazyProduct(c.gain.transpose());
}

void KalmanObserver::takePositionAsKnown(const ObserverInput& input) noexcept {
  const int n = layout_.joints;
  state_.head(n) = input.q;
  covariance_.topRows(n).setZero();
  covariance_.leftCols(n).setZero();
}

// Derivatives by differences as wide as the state is uncertain: what is narrower, friction near standstill,
// counts with its mean slope.
void KalmanObserver::linearise(const ObserverInput& input) noexcept {
  if (input.model == nullptr) {
    return;
  }
  const int n = layout_.joints;
  motion_ = motionAt(state_, input);
  map_ = motion_.map;
  slope_ = map_;
  const JointVector here = accelerationOf(motion_, state_, input.torque_Nm);
  for (int i = 0; i < 2 * n; ++i) {
    const bool is_velocity = i >= n;
    const double width = std::max(std::sqrt(std::max(covariance_(i, i), 0.0)),
                                  is_velocity ? kSmallestSpeed_rad_s : kSmallestTurn_rad);
    KalmanVector beside = state_;
    beside[i] += width;
    JointVector slope = (accelerationOf(motionAt(beside, input), beside, input.torque_Nm) - here) / width;
    slope_.col(i) = slope;
  }
}

}  // namespace patella::estimation
