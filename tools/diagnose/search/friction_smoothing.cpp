#include "tools/diagnose/search/friction_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {
namespace {

/// Shares of the joint's velocity (rms).
constexpr std::array kShares{0.002, 0.006, 0.02};
constexpr double kSlowest_rad_s = 1e-4;
/// Fall of the weighted squared error between velocities that the recording tells apart: six nats.
constexpr double kTold = 12.0;
/// Factor between neighbours at which the choice is fine enough.
constexpr double kFinest = 1.1;
/// The screening has to draw some chance, which is not looked at here.
constexpr int kReplicates = 2;

double velocityRms(const Dataset& data, int joint) {
  double sum = 0.0, count = 0.0;
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      sum += state.dq[joint] * state.dq[joint];
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

}  // namespace

namespace {

struct Choice {
  double velocity_rad_s = 0.0;
  double gain = 0.0;   // fall of the weighted squared error
  double least = 0.0;  // of those that it was chosen from
};

// The best of some velocities for each joint, among them the one chosen before.
void chooseFrom(ModelFitter& fitter, const ModelFit& nominal, std::uint64_t seed,
                const std::vector<std::vector<double>>& velocities, std::vector<Choice>& choices) {
  std::vector<std::shared_ptr<const Recipe>> candidates;
  std::vector<double> listed;
  for (std::size_t joint = 0; joint < velocities.size(); ++joint) {
    for (const double velocity : velocities[joint]) {
      listed.push_back(velocity);
      candidates.push_back(dryFriction(static_cast<int>(joint), velocity));
    }
  }
  if (candidates.empty()) {
    return;
  }
  const Atoms atoms = recipeAtoms(fitter, candidates);
  const Screening screening(fitter.data(), nominal, atoms, {.replicates = kReplicates, .seed = seed});
  for (const Screened& screened : screening.results()) {
    Choice& choice = choices[static_cast<std::size_t>(atoms.items[screened.atom].joint)];
    choice.least = std::min(choice.least, screened.raw_gain);
    if (screened.raw_gain > choice.gain) {
      choice.gain = screened.raw_gain;
      choice.velocity_rad_s = listed[screened.atom];
    }
  }
}

}  // namespace

std::vector<double> frictionSmoothing(ModelFitter& fitter, const ModelFit& nominal, std::uint64_t seed) {
  const Dataset& data = fitter.data();
  std::vector<std::vector<double>> grid;
  std::vector<Choice> choices;
  for (int joint = 0; joint < data.joints(); ++joint) {
    std::vector<double>& of_joint = grid.emplace_back();
    for (const double share : kShares) {
      of_joint.push_back(std::max(kSlowest_rad_s, share * velocityRms(data, joint)));
    }
    choices.push_back({.velocity_rad_s = of_joint.front(), .least = std::numeric_limits<double>::infinity()});
  }
  if (!data.isStatic()) {
    chooseFrom(fitter, nominal, seed, grid, choices);
    // A recording with little noise tells more than the grid: another friction would make up for the rest.
    for (double factor = std::sqrt(kShares[1] / kShares[0]); factor > kFinest; factor = std::sqrt(factor)) {
      std::vector<std::vector<double>> around(choices.size());
      for (std::size_t joint = 0; joint < choices.size(); ++joint) {
        if (choices[joint].gain - choices[joint].least > kTold) {
          const double velocity = choices[joint].velocity_rad_s;
          around[joint] = {velocity / factor, velocity * factor};
        }
      }
      chooseFrom(fitter, nominal, seed, around, choices);
    }
  }
  std::vector<double> smoothing;
  for (const Choice& choice : choices) {
    smoothing.push_back(choice.velocity_rad_s);
  }
  return smoothing;
}

}  // namespace patella::diagnose
