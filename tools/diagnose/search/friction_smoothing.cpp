#include "tools/diagnose/search/friction_smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/diagnose/search/screening.hpp"

namespace patella::diagnose {
namespace {

/// Shares of the joint's velocity (rms).
constexpr std::array kShares{0.002, 0.006, 0.02};
constexpr double kSlowest_rad_s = 1e-4;

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

std::vector<double> frictionSmoothing(ModelFitter& fitter, const ModelFit& nominal, std::uint64_t seed) {
  const Dataset& data = fitter.data();
  std::vector<double> smoothing;
  std::vector<std::shared_ptr<const Recipe>> candidates;
  std::vector<double> velocities;
  for (int joint = 0; joint < data.joints(); ++joint) {
    for (const double share : kShares) {
      velocities.push_back(std::max(kSlowest_rad_s, share * velocityRms(data, joint)));
      candidates.push_back(dryFriction(joint, velocities.back()));
    }
    smoothing.push_back(velocities[velocities.size() - kShares.size()]);
  }
  if (data.isStatic()) {
    return smoothing;
  }
  const Atoms atoms = recipeAtoms(fitter, candidates);
  const Screening screening(data, nominal, atoms, {.replicates = kFewestReplicates, .seed = seed});
  std::vector<double> best(smoothing.size(), 0.0);
  for (const Screened& screened : screening.results()) {
    const auto joint = static_cast<std::size_t>(atoms.items[screened.atom].joint);
    if (screened.raw_gain > best[joint]) {
      best[joint] = screened.raw_gain;
      smoothing[joint] = velocities[screened.atom];
    }
  }
  return smoothing;
}

}  // namespace patella::diagnose
