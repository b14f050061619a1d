#include "tools/diagnose/regression/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

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

std::vector<ElementaryColumn> elementaryColumns(const Dataset& data) {
  std::vector<ElementaryColumn> all;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const auto add = [&](std::string_view kind,
                         const std::function<double(const model::EffectInput&)>& torque) {
      all.push_back(
          {.kind = kind, .joint = joint, .torque = data.column({}, [&](const Series& s, std::size_t i) {
             JointVector value = JointVector::Zero(data.joints());
             value[joint] = torque(s.states[i]);
             return value;
           })});
    };
    add("viscous_friction", [=](const model::EffectInput& state) { return state.dq[joint]; });
    const double soft = std::max(kSoftest_rad_s, kSoft * jointRms(data, all.back().torque, joint));
    add("coulomb_friction",
        [=](const model::EffectInput& state) { return std::tanh(state.dq[joint] / soft); });
    add("linear_stiffness", [=](const model::EffectInput& state) { return state.q[joint]; });
    add("torque_bias", [](const model::EffectInput&) { return 1.0; });
  }
  return all;
}

}  // namespace patella::diagnose
