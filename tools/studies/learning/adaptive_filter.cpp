#include "tools/studies/learning/adaptive_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace patella::study {
namespace {

constexpr int kVelocity = 2;
constexpr int kPush = 4;
constexpr int kRate = 6;
constexpr int kAdapted = 8;
constexpr double kLargestPush_N = 10.0;  // standard deviation at the start, where the corner says nothing
constexpr double kRatePerSecond = 10.0;
constexpr double kStartVelocity_rad_s = 1.0;
constexpr double kSmallestTurn_rad = 1e-4;
constexpr double kSmallestSpeed_rad_s = 1e-3;

double squared(double x) noexcept {
  return x * x;
}

/// (w, rate) a while later, of a critically damped low-pass at rest but for them.
Eigen::Matrix2d pushTransition(double corner_rad_s, double time_s) noexcept {
  const double turned = corner_rad_s * time_s;
  Eigen::Matrix2d transition;
  transition << 1.0 + turned, time_s, -corner_rad_s * turned, 1.0 - turned;
  return std::exp(-turned) * transition;
}

}  // namespace

AdaptiveFilter::AdaptiveFilter(const AdaptiveSettings& settings)
    : settings_(settings), adapted_(static_cast<int>(settings.body.cols()) + 4) {
  prior_deviation_.resize(adapted_);
  prior_deviation_.head(adapted_ - 4).setConstant(settings.body_deviation);
  prior_deviation_.segment(adapted_ - 4, 2).setConstant(settings.viscous_deviation_Nms_rad);
  prior_deviation_.tail(2).setConstant(settings.coulomb_deviation_Nm);
  state_.setZero(kAdapted + adapted_);
  covariance_.setZero(kAdapted + adapted_, kAdapted + adapted_);
}

void AdaptiveFilter::reset(const estimation::ObserverInput& input) noexcept {
  state_.setZero();
  covariance_.setZero();
  covariance_.diagonal().tail(adapted_) = prior_deviation_.cwiseAbs2();
  restart(input);
}

void AdaptiveFilter::restart(const estimation::ObserverInput& input) noexcept {
  const double corner_rad_s = 2.0 * std::numbers::pi * settings_.push_corner_Hz;
  state_.head(2) = input.q;
  state_.segment(2, kAdapted - 2).setZero();
  acceleration_.setZero();
  covariance_.topRows(kAdapted).setZero();
  covariance_.leftCols(kAdapted).setZero();
  for (int i = 0; i < 2; ++i) {
    // The low-pass in its steady state.
    const double drive = squared(settings_.push_density[static_cast<std::size_t>(i)]);
    covariance_(i, i) = squared(settings_.position_noise_rad);
    covariance_(kVelocity + i, kVelocity + i) = squared(kStartVelocity_rad_s);
    covariance_(kPush + i, kPush + i) =
        std::min(squared(kLargestPush_N), drive / (4.0 * squared(corner_rad_s) * corner_rad_s));
    covariance_(kRate + i, kRate + i) =
        std::min(squared(kRatePerSecond * kLargestPush_N), drive / (4.0 * corner_rad_s));
  }
}

JointVector AdaptiveFilter::update(const estimation::ObserverInput& input) noexcept {
  predict(input);
  for (int joint = 0; joint < 2; ++joint) {
    correct(joint, input.q[joint], settings_.position_noise_rad);
  }
  return input.terms.inverse_inertia * push_Nm(input, 0.0);
}

JointVector AdaptiveFilter::push_Nm(const estimation::ObserverInput& input, double ahead_s) const noexcept {
  AdaptiveVector state = state_;
  if (ahead_s > 0.0) {
    const Eigen::Vector2d acceleration = motionAt(state_, input).acceleration;
    state.head(2) += ahead_s * state.segment(kVelocity, 2) + 0.5 * squared(ahead_s) * acceleration;
    const Eigen::Matrix2d later = pushTransition(2.0 * std::numbers::pi * settings_.push_corner_Hz, ahead_s);
    state.segment(kPush, 2) = later(0, 0) * state_.segment(kPush, 2) + later(0, 1) * state_.segment(kRate, 2);
  }
  return input.model->mechanism().jacobian(state.head(2)).transpose() * state.segment(kPush, 2);
}

AdaptiveFilter::Motion AdaptiveFilter::motionAt(const AdaptiveVector& state,
                                                const estimation::ObserverInput& input) const noexcept {
  const JointVector q = state.head(2);
  const JointVector dq = state.segment(kVelocity, 2);
  const auto terms = input.model->evaluate({.q = q,
                                            .dq = dq,
                                            .torque_Nm = input.torque_Nm,
                                            .activation = input.activation,
                                            .time_s = input.time_s});
  const model::Mechanism& mechanism = input.model->mechanism();
  const model::BaseParameters wrong = settings_.body * state.segment(kAdapted, adapted_ - 4);
  const Eigen::Vector2d still = mechanism.regressor(q, dq, JointVector::Zero(2)) * wrong;
  Eigen::Matrix2d inertia = terms.inertia;
  for (int joint = 0; joint < 2; ++joint) {
    inertia.col(joint) += mechanism.regressor(q, dq, JointVector::Unit(2, joint)) * wrong - still;
  }
  const auto viscous = state.segment(state.size() - 4, 2);
  const auto coulomb = state.tail(2);
  const Eigen::Vector2d rubbing =
      viscous.cwiseProduct(dq) +
      coulomb.cwiseProduct((dq / settings_.smoothing_rad_s).array().tanh().matrix());
  Motion motion;
  motion.inverse_inertia = inertia.inverse();
  motion.acceleration =
      motion.inverse_inertia * (input.torque_Nm - terms.bias_Nm - still - rubbing +
                                mechanism.jacobian(q).transpose() * state.segment(kPush, 2));
  return motion;
}

// By position and velocity as wide as they are uncertain, so that friction near standstill counts with its
// mean slope; exact where the motion is linear.
AdaptiveFilter::Map AdaptiveFilter::slopeAt(const Motion& motion,
                                            const estimation::ObserverInput& input) const noexcept {
  const JointVector q = state_.head(2);
  const JointVector dq = state_.segment(kVelocity, 2);
  Map slope = Map::Zero(2, state_.size());
  for (int i = 0; i < kPush; ++i) {
    const double width = std::max(std::sqrt(std::max(covariance_(i, i), 0.0)),
                                  i < kVelocity ? kSmallestTurn_rad : kSmallestSpeed_rad_s);
    AdaptiveVector beside = state_;
    beside[i] += width;
    slope.col(i) = (motionAt(beside, input).acceleration - motion.acceleration) / width;
  }
  const model::Mechanism& mechanism = input.model->mechanism();
  slope.middleCols(kPush, 2) = motion.inverse_inertia * mechanism.jacobian(q).transpose();
  slope.middleCols(kAdapted, adapted_ - 4) =
      -motion.inverse_inertia * (mechanism.regressor(q, dq, acceleration_) * settings_.body);
  for (int joint = 0; joint < 2; ++joint) {
    const Eigen::Index viscous = state_.size() - 4 + joint;
    slope.col(viscous) = -motion.inverse_inertia.col(joint) * dq[joint];
    slope.col(viscous + 2) =
        -motion.inverse_inertia.col(joint) * std::tanh(dq[joint] / settings_.smoothing_rad_s);
  }
  return slope;
}

void AdaptiveFilter::predict(const estimation::ObserverInput& input) noexcept {
  const double dt = input.dt_s;
  const Motion motion = motionAt(state_, input);
  acceleration_ += -std::expm1(-2.0 * std::numbers::pi * settings_.acceleration_cutoff_Hz * dt) *
                   (motion.acceleration - acceleration_);
  const Map slope = slopeAt(motion, input);
  AdaptiveMatrix transition = AdaptiveMatrix::Identity(state_.size(), state_.size());
  transition.topRows(2) += 0.5 * dt * dt * slope;
  transition.block(0, kVelocity, 2, 2).diagonal().array() += dt;
  transition.middleRows(kVelocity, 2) += dt * slope;
  const Eigen::Matrix2d push = pushTransition(2.0 * std::numbers::pi * settings_.push_corner_Hz, dt);
  for (int row = 0; row < 2; ++row) {
    for (int col = 0; col < 2; ++col) {
      transition.block(kPush + 2 * row, kPush + 2 * col, 2, 2).diagonal().setConstant(push(row, col));
    }
  }

  const Eigen::Vector2d begin = motion.acceleration;
  const Eigen::Vector2d w = state_.segment(kPush, 2);
  const Eigen::Vector2d rate = state_.segment(kRate, 2);
  state_.head(2) += dt * state_.segment(kVelocity, 2) + 0.5 * dt * dt * begin;
  state_.segment(kVelocity, 2) += dt * begin;
  state_.segment(kPush, 2) = push(0, 0) * w + push(0, 1) * rate;
  state_.segment(kRate, 2) = push(1, 0) * w + push(1, 1) * rate;
  const Eigen::Vector2d change = motionAt(state_, input).acceleration - begin;
  state_.head(2) += 0.25 * dt * dt * change;
  state_.segment(kVelocity, 2) += 0.5 * dt * change;

  const AdaptiveMatrix moved = transition * covariance_;
  covariance_.noalias() = moved * transition.transpose();
  addNoise(motion, dt);
  const AdaptiveMatrix transposed = covariance_.transpose();
  covariance_ = 0.5 * (covariance_ + transposed);
}

void AdaptiveFilter::addNoise(const Motion& motion, double dt_s) noexcept {
  const double dt = dt_s;
  const Eigen::Matrix2d of_velocity =
      squared(settings_.torque_noise_Nm * dt) * motion.inverse_inertia * motion.inverse_inertia.transpose();
  covariance_.block(0, 0, 2, 2) += 0.25 * dt * dt * of_velocity;
  covariance_.block(0, kVelocity, 2, 2) += 0.5 * dt * of_velocity;
  covariance_.block(kVelocity, 0, 2, 2) += 0.5 * dt * of_velocity;
  covariance_.block(kVelocity, kVelocity, 2, 2) += of_velocity;
  for (int i = 0; i < 2; ++i) {
    const double drive = squared(settings_.push_density[static_cast<std::size_t>(i)]) * dt;
    covariance_(kPush + i, kPush + i) += dt * dt / 3.0 * drive;
    covariance_(kPush + i, kRate + i) += 0.5 * dt * drive;
    covariance_(kRate + i, kPush + i) += 0.5 * dt * drive;
    covariance_(kRate + i, kRate + i) += drive;
  }
  covariance_.diagonal().tail(adapted_) += squared(settings_.drift) * dt * prior_deviation_.cwiseAbs2();
}

void AdaptiveFilter::correct(int state, double measured, double noise) noexcept {
  const double variance = covariance_(state, state) + squared(noise);
  const AdaptiveVector gain = covariance_.col(state) / variance;
  state_ += (measured - state_[state]) * gain;
  covariance_ -= variance * gain * gain.transpose();
}

}  // namespace patella::study
