#include "tools/studies/learning/shank_share.hpp"

#include <Eigen/LU>

#include "core/model/presets.hpp"

namespace patella::study {
namespace {

constexpr double kSingular_m2 = 0.005;  // ρ
/// S: a push of 1 N that stays for 0.3 s, over shares of 0.087, as between −0.15 and 0.15.
constexpr double kPrior_N2s = 40.0;

JointVector pairAt(const tick::FeatureVector& features, int first) {
  const auto i = static_cast<std::size_t>(first);
  return Eigen::Vector2d(features[i], features[i + 1]);
}

}  // namespace

ShankShare::ShankShare(const model::Mechanism& model)
    : kinematics_(model::physicalLeg().parameters), shank_(directionsOf(AdaptedBody::kShank)) {
  // The second base parameter is the shank's alone: as much heavier as the model believes it to be.
  shank_ *= model.baseParameters()[1] / kinematics_.baseParameters()[1];
}

JointVector ShankShare::update(const tick::FeatureVector& features, double dt_s) {
  const JointVector q = pairAt(features, tick::kPosition);
  const Eigen::Vector2d taken =
      kinematics_.regressor(q, pairAt(features, tick::kVelocity), pairAt(features, tick::kAcceleration)) *
      shank_;
  const Eigen::Vector2d observed = pairAt(features, tick::kObserverTorque);
  const Eigen::Matrix2d jacobian = kinematics_.jacobian(q);
  const Eigen::Matrix2d force = jacobian.transpose() * jacobian + kSingular_m2 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d weighed = force.inverse() * taken;
  with_observer_ += dt_s * weighed.dot(observed);
  with_itself_ += dt_s * weighed.dot(taken);
  share_ = -with_observer_ / (with_itself_ + kPrior_N2s);
  return share_ * taken;
}

}  // namespace patella::study
