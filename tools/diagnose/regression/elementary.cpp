#include "tools/diagnose/regression/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patella::diagnose {
namespace {

/// Share of a joint's velocity below which dry friction is not fully there, so that reversals do not ring.
constexpr double kSoft = 0.05;
constexpr double kSoftest_rad_s = 1e-6;

}  // namespace

double jointRms(const Dataset& data, const Eigen::Ref<const Eigen::VectorXd>& column, int joint) {
  return std::sqrt(column.segment(joint * data.rows(), data.rows()).squaredNorm() /
                   static_cast<double>(data.rows()));
}

std::vector<double> jointRms(const Dataset& data, const Eigen::Ref<const Eigen::VectorXd>& column) {
  std::vector<double> rms;
  for (int joint = 0; joint < data.joints(); ++joint) {
    rms.push_back(jointRms(data, column, joint));
  }
  return rms;
}

std::array<double, 2> positionRange(const Dataset& data, int joint) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      lowest = std::min(lowest, state.q[joint]);
      highest = std::max(highest, state.q[joint]);
    }
  }
  return {lowest, highest};
}

double rangeOf(const Dataset& data, int joint) {
  const auto [lowest, highest] = positionRange(data, joint);
  return highest - lowest;
}

std::vector<ElementaryEffect> elementaryEffects(const Dataset& data) {
  std::vector<ElementaryEffect> all;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const Eigen::VectorXd velocity =
        data.variable([joint](const Series& s, std::size_t i) { return s.states[i].dq[joint]; });
    const double rms_rad_s = std::sqrt(velocity.squaredNorm() / static_cast<double>(velocity.size()));
    const double soft = std::max(kSoftest_rad_s, kSoft * rms_rad_s);
    all.push_back({.kind = "viscous_friction", .joint = joint, .torque_Nm = [joint](const auto& state) {
                     return state.dq[joint];
                   }});
    all.push_back({.kind = "coulomb_friction", .joint = joint, .torque_Nm = [joint, soft](const auto& state) {
                     return std::tanh(state.dq[joint] / soft);
                   }});
    all.push_back({.kind = "linear_stiffness", .joint = joint, .torque_Nm = [joint](const auto& state) {
                     return state.q[joint];
                   }});
    all.push_back({.kind = "torque_bias", .joint = joint, .torque_Nm = [](const auto&) { return 1.0; }});
  }
  return all;
}

std::vector<ElementaryColumn> elementaryColumns(const Dataset& data) {
  std::vector<ElementaryColumn> all;
  for (const ElementaryEffect& effect : elementaryEffects(data)) {
    all.push_back({.kind = effect.kind,
                   .joint = effect.joint,
                   .torque = data.jointColumn(effect.joint, [&](const Series& s, std::size_t i) {
                     return effect.torque_Nm(s.states[i]);
                   })});
  }
  return all;
}

}  // namespace patella::diagnose
