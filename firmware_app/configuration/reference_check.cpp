#include "firmware_app/configuration/reference_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include "core/control/reference_trajectory.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::app {
namespace {

/// Of a run without an end, and of a long one: slow motions of several sines meet each other within it.
constexpr double kLongest_s = 120.0;
/// Short against the period of anything that a leg can follow.
constexpr double kStep_s = 0.005;

/// Whether the pose at activation has no part in the motion once it has been entered.
bool isTold(const control::JointMotion& motion) {
  const auto* hold = std::get_if<control::HoldMotion>(&motion);
  return hold == nullptr || hold->position_rad.has_value();
}

double entered_s(const control::ReferenceSettings& settings, int joint) {
  const auto* move = std::get_if<control::MoveMotion>(&settings.motion[static_cast<std::size_t>(joint)]);
  return move != nullptr ? move->duration_s : settings.blend_s;
}

}  // namespace

std::vector<JointReference> referenceRanges(const RunConfig& config) {
  const control::ReferenceSettings& settings = config.tick.reference;
  const int joints = config.model.joints();
  control::ReferenceTrajectory trajectory(joints, settings);
  trajectory.start(JointVector::Zero(joints));
  std::vector<JointReference> result;
  double entered = 0.0;
  for (int joint = 0; joint < joints; ++joint) {
    if (isTold(settings.motion[static_cast<std::size_t>(joint)])) {
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      result.push_back({joint, kInfinity, -kInfinity, 0.0});
      entered = std::max(entered, entered_s(settings, joint));
    }
  }
  const double run_s = static_cast<double>(config.loop.max_ticks) * config.tick.period_s;
  const double length_s = run_s > 0.0 ? std::min(run_s, kLongest_s) : kLongest_s;
  for (double time_s = entered; time_s <= entered + length_s; time_s += kStep_s) {
    const control::ReferencePoint point = trajectory.at(time_s);
    for (JointReference& found : result) {
      found.lowest_rad = std::min(found.lowest_rad, point.q[found.joint]);
      found.highest_rad = std::max(found.highest_rad, point.q[found.joint]);
      found.fastest_rad_s = std::max(found.fastest_rad_s, std::abs(point.dq[found.joint]));
    }
  }
  return result;
}

void requireWithinLimits(const RunConfig& config) {
  for (const JointReference& found : referenceRanges(config)) {
    const safety::JointLimits& limits = config.tick.limits.joint[static_cast<std::size_t>(found.joint)];
    const char* const unit = model::isPrismatic(config.model.mechanism, found.joint) ? "m" : "rad";
    if (found.lowest_rad < limits.q_min_rad || found.highest_rad > limits.q_max_rad) {
      throw FileError(config.path.string() +
                      fmt::format(": reference of joint {} goes from {:.3g} to {:.3g} {}, expected within "
                                  "safety.q_min_rad and safety.q_max_rad, {:.3g} to {:.3g}",
                                  found.joint + 1, found.lowest_rad, found.highest_rad, unit,
                                  limits.q_min_rad, limits.q_max_rad));
    }
    if (found.fastest_rad_s >= limits.velocity_rad_s) {
      throw FileError(config.path.string() +
                      fmt::format(": reference of joint {} reaches {:.3g} {}/s, expected less than "
                                  "safety.velocity_rad_s, {:.3g}",
                                  found.joint + 1, found.fastest_rad_s, unit, limits.velocity_rad_s));
    }
  }
}

}  // namespace patella::app
