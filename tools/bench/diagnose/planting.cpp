#include "tools/bench/diagnose/planting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/model/effect.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::bench {
namespace {

using diagnose::Recording;
using diagnose::Segment;

/// Kinds whose torque grows with one number.
constexpr std::array kKinds{"coulomb_friction", "viscous_friction", "linear_stiffness", "torque_bias",
                            "rotor_inertia",    "payload",          "actuator_lag",     "actuator_delay"};
/// Largest strength that is planted, in units of the smallest that would have been revealed. …
constexpr double kStrongest = 5.0;
/// … And as a share of the joint's torque: what is more would be another machine.
constexpr double kLargestShare = 1.0;

double middleOf(const Recording& recording, int joint) {
  const Segment& rows = recording.segments.front();
  const auto& position = recording.position_rad[static_cast<std::size_t>(joint)];
  const auto [low, high] = std::minmax_element(position.begin() + static_cast<std::ptrdiff_t>(rows.first),
                                               position.begin() + static_cast<std::ptrdiff_t>(rows.end));
  return 0.5 * (*low + *high);
}

// The shape that the smallest size belongs to; a spring rests somewhere else.
std::vector<double> parametersOf(const diagnose::Revealed& revealed, double size, double rest_position_rad) {
  std::vector<double> values = revealed.parameters;
  const auto& ranges = model::findEffect(revealed.kind)->parameters;
  for (std::size_t p = 0; p < values.size(); ++p) {
    if (ranges[p].name == revealed.parameter) {
      values[p] = std::clamp(size, ranges[p].minimum, ranges[p].maximum);
    } else if (ranges[p].name == "rest_position_rad") {
      values[p] = std::clamp(rest_position_rad, ranges[p].minimum, ranges[p].maximum);
    }
  }
  return values;
}

}  // namespace

std::optional<PlantedEffect> drawPlant(const diagnose::Diagnosis& best, const Recording& recording,
                                       Random& random) {
  const diagnose::Dataset data(std::span(&recording, 1), {});
  const std::vector<bool> driven = diagnose::drivenJoints(
      data, model::makeModel({.mechanism = best.extended.mechanism, .effects = {}}).mechanism());
  std::vector<const diagnose::Revealed*> possible;
  for (const diagnose::Revealed& revealed : best.revealed) {
    const bool drawn = std::find(kKinds.begin(), kKinds.end(), revealed.kind) != kKinds.end();
    const bool late = revealed.kind == "actuator_lag" || revealed.kind == "actuator_delay";
    if (drawn && driven[static_cast<std::size_t>(revealed.joint)] && std::isfinite(revealed.smallest_size) &&
        revealed.smallest_size > 0.0 && revealed.share_of_torque < kLargestShare &&
        !(late && revealed.smallest_size > diagnose::convention::kLeastShift_s)) {
      possible.push_back(&revealed);
    }
  }
  if (possible.empty()) {
    return std::nullopt;
  }
  const diagnose::Revealed& smallest = *possible[random.below(possible.size())];
  PlantedEffect plant{
      .kind = smallest.kind, .joint = smallest.joint, .parameters = {}, .main = smallest.parameter};
  plant.in_smallest =
      random.chance(0.5)
          ? 1.0
          : random.logUniform(1.0, std::min(kStrongest, kLargestShare / smallest.share_of_torque));
  plant.size =
      plant.in_smallest * smallest.smallest_size * (plant.kind == "torque_bias" ? random.sign() : 1.0);
  plant.parameters =
      parametersOf(smallest, plant.size, middleOf(recording, plant.joint) + random.uniform(-0.3, 0.3));
  return plant;
}

void plantIn(Recording& recording, const PlantedEffect& plant, const model::Mechanism& mechanism) {
  constexpr double kEveryRow_Hz = 1e6;
  const diagnose::Dataset data(std::span(&recording, 1), {.evaluation_rate_Hz = kEveryRow_Hz});
  const auto effect = model::makeEffect(plant.kind, plant.joint, mechanism, plant.parameters);
  const std::size_t first = recording.segments.front().first;
  const diagnose::Series& series = data.series().front();
  const auto torque = [&](std::size_t i, double later_s) {
    const double place = std::clamp(static_cast<double>(i) + later_s * series.rate_Hz, 0.0,
                                    static_cast<double>(series.states.size() - 1));
    const auto low = std::min(static_cast<std::size_t>(place), series.states.size() - 2);
    const double share = place - static_cast<double>(low);
    return (1.0 - share) * series.measured_torque_Nm[low][plant.joint] +
           share * series.measured_torque_Nm[low + 1][plant.joint];
  };
  std::vector<JointVector> planted(series.states.size(), JointVector::Zero(recording.joints));
  effect->reset(series.states.front());
  for (std::size_t i = 0; i < planted.size(); ++i) {
    if (plant.kind == "actuator_delay") {
      planted[i][plant.joint] = torque(i, plant.parameters[0]) - torque(i, 0.0);
    } else if (plant.kind == "actuator_lag") {
      const double step_s = 1.0 / series.rate_Hz;
      planted[i][plant.joint] =
          plant.parameters[0] * (torque(i, step_s) - torque(i, -step_s)) / (2.0 * step_s);
    } else {
      if (i > 0) {
        effect->advance(series.states[i], 1.0 / series.rate_Hz);
      }
      planted[i] =
          effect->inertia(series.states[i].q) * series.acceleration[i] - effect->torque(series.states[i]);
    }
  }
  if (recording.torque_timing == diagnose::TorqueTiming::kHeld) {
    // Row i acts until row i + 1: at the instant itself it would come half a sample late.
    for (std::size_t i = 0; i + 1 < planted.size(); ++i) {
      planted[i] = 0.5 * (planted[i] + planted[i + 1]);
    }
  }
  if (recording.torque_timing == diagnose::TorqueTiming::kBefore) {
    for (std::size_t i = planted.size() - 1; i > 0; --i) {
      planted[i] = 0.5 * (planted[i] + planted[i - 1]);
    }
  }
  // A load on one joint is carried by those before it, too.
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    for (std::size_t i = 0; i < planted.size(); ++i) {
      recording.torque_Nm[j][first + i] += planted[i][static_cast<Eigen::Index>(j)];
    }
  }
}

}  // namespace patella::bench
