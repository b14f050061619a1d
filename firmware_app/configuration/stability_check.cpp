#include "firmware_app/configuration/stability_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include "core/control/drive_anticipation.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::app {
namespace {

/// Up to two joints: a grid. More: the corners of the ranges, where inertias are often least and largest, and
/// points that fill the rest evenly.
constexpr int kJointsOfGrid = 2;
constexpr int kPosesPerJoint = 9;
constexpr int kFillingPoses = 1000;
constexpr int kInertias = 7;  ///< from the lowest to the highest

struct InertiaRange {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = 0.0;
  void add(double inertia) {
    lowest = std::min(lowest, inertia);
    highest = std::max(highest, inertia);
  }
};

/// Digits of `index` behind the point, in that base: of a prime base for each coordinate, Halton's sequence,
/// which fills a cube evenly. Halton, On the efficiency of certain quasi-random sequences of points, 1960.
double radicalInverse(int index, int base) {
  double value = 0.0;
  for (double digit = 1.0 / base; index > 0; index /= base, digit /= base) {
    value += digit * (index % base);
  }
  return value;
}

/// Within each joint's range, 0 at its lower end and 1 at its upper.
std::vector<JointVector> shares(int joints) {
  constexpr std::array<int, kMaxJoints> kPrimes{2, 3, 5, 7, 11, 13, 17, 19};
  const bool grid = joints <= kJointsOfGrid;
  const int steps = grid ? kPosesPerJoint : 2;
  const auto regular = static_cast<int>(std::lround(std::pow(steps, joints)));
  std::vector<JointVector> all;
  for (int pose = 0; pose < regular + (grid ? 0 : kFillingPoses); ++pose) {
    JointVector share(joints);
    for (int joint = 0, rest = pose; joint < joints; ++joint, rest /= steps) {
      share[joint] = pose < regular
                         ? static_cast<double>(rest % steps) / (steps - 1)
                         : radicalInverse(pose - regular + 1, kPrimes[static_cast<std::size_t>(joint)]);
    }
    all.push_back(share);
  }
  return all;
}

// With the other joints free, 1/(I⁻¹)ⱼⱼ, and held, Iⱼⱼ: they are something between.
std::vector<InertiaRange> inertiaRanges(const RunConfig& config) {
  const model::DynamicsModel model = makeModel(config.model);
  const int joints = model.joints();
  std::vector<InertiaRange> ranges(static_cast<std::size_t>(joints));
  for (const JointVector& share : shares(joints)) {
    model::EffectInput state{JointVector::Zero(joints), JointVector::Zero(joints), JointVector::Zero(joints)};
    for (int joint = 0; joint < joints; ++joint) {
      const safety::JointLimits& limits = config.tick.limits.joint[static_cast<std::size_t>(joint)];
      state.q[joint] = limits.q_min_rad + share[joint] * (limits.q_max_rad - limits.q_min_rad);
    }
    const model::ModelTerms terms = model.evaluate(state);
    for (int joint = 0; joint < joints; ++joint) {
      ranges[static_cast<std::size_t>(joint)].add(terms.inertia(joint, joint));
      ranges[static_cast<std::size_t>(joint)].add(1.0 / terms.inverse_inertia(joint, joint));
    }
  }
  return ranges;
}

bool measuresVelocity(const RunConfig& config, int joint) {
  const std::string name = "velocity_rad_s." + std::to_string(joint + 1);
  const auto& bindings = config.bus.map.bindings;
  return std::any_of(bindings.begin(), bindings.end(),
                     [&](const can::Binding& binding) { return binding.input == name; });
}

control::JointLoop jointLoop(const RunConfig& config, int joint, double lateness_s) {
  const tick::TickSettings& tick = config.tick;
  return {
      .stiffness_Nm_rad = tick.gains.stiffness_Nm_rad[joint],
      .damping_Nms_rad = tick.gains.damping_Nms_rad[joint],
      .compensation = tick.compensation == tick::CompensationSource::kNone ? 0.0 : tick.gains.compensation,
      .lateness_s = lateness_s,
      .period_s = 1.0 / config.loop.rate_Hz,
      .velocity_cutoff_Hz = measuresVelocity(config, joint) ? 0.0 : tick.velocity_cutoff_Hz,
      .estimate_cutoff_Hz = tick.estimate_cutoff_Hz};
}

void keepLeast(control::PhaseMargin& least, const control::PhaseMargin& other) {
  if (other.margin_deg < least.margin_deg) {
    least = other;
  }
}

}  // namespace

std::vector<JointStability> jointStability(const RunConfig& config) {
  const std::vector<InertiaRange> ranges = inertiaRanges(config);
  const auto lateness = makeModel(config.model).driveLateness();
  constexpr control::PhaseMargin kNone{std::numeric_limits<double>::infinity(), 0.0, 0.0};
  std::vector<JointStability> result;
  for (std::size_t joint = 0; joint < ranges.size(); ++joint) {
    const InertiaRange& range = ranges[joint];
    const double late_s = control::DriveAnticipation::lateness_s(lateness[joint], 1.0 / config.loop.rate_Hz);
    JointStability stability{.with_model = kNone,
                             .within_tolerance = kNone,
                             .lowest_inertia_kg_m2 = range.lowest,
                             .highest_inertia_kg_m2 = range.highest,
                             .lateness_s = late_s};
    const control::JointLoop loop = jointLoop(config, static_cast<int>(joint), late_s);
    for (int i = 0; i < kInertias; ++i) {
      const double share = static_cast<double>(i) / (kInertias - 1);
      const double inertia = range.lowest * std::pow(range.highest / range.lowest, share);
      keepLeast(stability.with_model, control::phaseMargin(loop, inertia, inertia));
      keepLeast(stability.within_tolerance, control::leastPhaseMargin(loop, inertia));
    }
    result.push_back(stability);
  }
  return result;
}

void requireStable(const RunConfig& config) {
  const std::vector<JointStability> joints = jointStability(config);
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const JointStability& found = joints[joint];
    const bool model = found.with_model.margin_deg >= control::kLeastMargin_deg;
    if (model && found.within_tolerance.margin_deg > 0.0) {
      continue;
    }
    const control::PhaseMargin& worse = model ? found.within_tolerance : found.with_model;
    const auto index = static_cast<Eigen::Index>(joint);
    throw FileError(
        config.path.string() + ": " +
        fmt::format("control: phase margin of joint {} is {:.0f}° at {:.2g} Hz (stiffness {:.4g} N·m/rad, "
                    "damping {:.4g} N·m·s/rad, inertia {:.3g} kg·m², drive late by {:.3g} ms), "
                    "expected {}; lower the gains, or damp more where the margin is small at "
                    "low frequencies",
                    joint + 1, worse.margin_deg, worse.frequency_Hz,
                    config.tick.gains.stiffness_Nm_rad[index], config.tick.gains.damping_Nms_rad[index],
                    worse.inertia_kg_m2, 1e3 * found.lateness_s,
                    model ? fmt::format("more than 0 with an inertia off by {:.0f} %",
                                        100.0 * control::kInertiaTolerance)
                          : fmt::format("at least {:.0f}°", control::kLeastMargin_deg)));
  }
}

}  // namespace patella::app
