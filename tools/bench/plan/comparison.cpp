#include "tools/bench/plan/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/result/parameter_text.hpp"

namespace patella::bench {
namespace {

using namespace diagnose;

/// What is missing of machines, but for payload and rotor inertia, which are what other nominal parameters
/// would be, an encoder's zero what other centres of mass would be, and no motion tells more of them than the
/// tolerance of the model does.
const std::vector<std::string> kLookedAt{"coulomb_friction",        "viscous_friction", "asymmetric_friction",
                                         "stribeck_friction",       "linear_stiffness", "torque_bias",
                                         "load_dependent_friction", "actuator_lag"};

double sizeOf(const Revealed& revealed) {
  return std::isfinite(revealed.smallest_size) ? revealed.smallest_size
                                               : physicalRange(revealed.kind, revealed.parameter)[1];
}

double meanLogarithm(const std::vector<Revealed>& all) {
  double sum = 0.0;
  for (const Revealed& revealed : all) {
    sum += std::log(sizeOf(revealed));
  }
  return sum / static_cast<double>(all.size());
}

void addFriction(Machine& machine, double share) {
  for (int j = 0; j < machine.nominal.joints(); ++j) {
    constexpr double kSmoothing_rad_s = 0.01;
    const double level_Nm = share * machine.limits.joint[static_cast<std::size_t>(j)].torque_Nm;
    const model::EffectDescription friction{
        .kind = "coulomb_friction", .joint = j, .parameters = {level_Nm, kSmoothing_rad_s}};
    machine.nominal.effects.push_back(friction);
    machine.truth.effects.push_back(friction);
  }
}

struct Sine {
  std::vector<Revealed> revealed;
  SampledMotion motion;
};

Sine bestSine(const PlanRequest& request) {
  const int joints = request.model.joints();
  const MotionLimits limits = usableLimits(request.limits, joints);
  const std::vector<std::vector<double>> frequency_Hz(static_cast<std::size_t>(joints), {kSine_Hz});
  MotionFamily family(request.timing, frequency_Hz, limits, {}, request.start_rad, request.model);
  Sine best;
  double lowest = std::numeric_limits<double>::infinity();
  constexpr int kPhases = 4, kSizes = 10;
  for (int phase = 0; phase < (joints > 1 ? kPhases : 1); ++phase) {
    Eigen::VectorXd point = Eigen::VectorXd::Zero(family.dimensions());
    for (int j = 0; j < joints; ++j) {
      const double angle = 2.0 * std::numbers::pi * phase * j / kPhases;
      point[family.firstAmplitude(j) - 1] = 1.0;
      point[family.firstAmplitude(j)] = std::cos(angle);
      point[family.firstAmplitude(j) + 1] = std::sin(angle);
    }
    const auto largest = family.at(point);
    for (int size = 1; largest && size <= kSizes; ++size) {
      FourierMotion motion = *largest;
      motion.amplitude_rad *= static_cast<double>(size) / kSizes;
      Sine sine{.revealed = {}, .motion = family.sampled(motion)};
      sine.revealed = revealedBy(request, sine.motion);
      if (const double mean = meanLogarithm(sine.revealed); mean < lowest) {
        lowest = mean;
        best = std::move(sine);
      }
    }
  }
  if (best.revealed.empty()) {
    throw std::runtime_error("no sine fits the limits");
  }
  return best;
}

}  // namespace

Comparison compare(Machine machine, const CompareOptions& options) {
  if (options.dry_friction > 0.0) {
    addFriction(machine, options.dry_friction);
  }
  PlanRequest request;
  request.model = machine.nominal;
  request.limits = machine.limits;
  request.start_rad = machine.start_rad;
  request.effects = kLookedAt;
  for (int j = 0; j < machine.nominal.joints(); ++j) {
    request.noise.push_back(
        {.noise_Nm = kUsualNoise * machine.limits.joint[static_cast<std::size_t>(j)].torque_Nm});
  }
  request.nominal_tolerance = options.nominal_tolerance;
  request.timing.duration_s = options.duration_s;
  request.design.evaluations = options.evaluations;
  request.design.seed = options.seed;
  const Sine sine = bestSine(request);
  const Revealed& least = *std::max_element(
      sine.revealed.begin(), sine.revealed.end(),
      [](const Revealed& a, const Revealed& b) { return a.share_of_torque < b.share_of_torque; });
  request.effects = {fmt::format("{}@{}", least.kind, least.joint + 1)};
  const auto start = std::chrono::steady_clock::now();
  const MotionPlan plan = makePlan(request);
  Comparison comparison;
  comparison.machine = machine.name;
  comparison.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Revealed& planned = plan.revealed.front();
  comparison.effect = request.effects.front();
  comparison.sine = sizeOf(revealedBy(request, sine.motion).front());
  comparison.headroom = plan.headroom.front();
  comparison.planned = sizeOf(planned);
  std::vector<model::EffectDescription> hidden;
  if (!planned.parameters.empty()) {
    hidden.push_back({.kind = planned.kind, .joint = planned.joint, .parameters = planned.parameters});
  }
  comparison.taken = follow(machine, hidden, plan.motion.reference, options.duration_s);
  return comparison;
}

}  // namespace patella::bench
