#include "tools/diagnose/search/late_drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/lateness.hpp"
#include "tools/diagnose/search/estimates.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// As far up as encoders let accelerations be known.
constexpr DatasetOptions kFast{.smoothing_Hz = 100.0, .evaluation_rate_Hz = 1000.0, .band_Hz = 40.0};

// Those whose torque the model explains but for little, and for what a late drive makes of it.
std::vector<int> undisturbed(const Dataset& data, const model::ModelDescription& explained,
                             std::span<const int> joints) {
  model::DynamicsModel dynamics = model::makeModel(explained);
  const Column torque = data.driveTorque();
  const Column left = besideLateness(data, torque - data.modelTorque(dynamics));
  std::vector<int> clean(joints.begin(), joints.end());
  std::erase_if(clean, [&](int joint) {
    return jointRms(data, left, joint) >= late_drive::kUndisturbed * jointRms(data, torque, joint);
  });
  return clean;
}

// Those where a candidate would pay for its parameters, were the noise white: chance, which takes long to
// draw, only asks for more.
std::vector<int> promising(ModelFitter& fitter, const ModelFit& nominal, const Atoms& atoms) {
  const Screening screening(fitter.data(), nominal, atoms, {.replicates = kFewestReplicates});
  std::vector<int> joints;
  for (const Candidate& candidate : rank(atoms, screening, parameterCost(nominal))) {
    if (candidate.refused_because.empty()) {
      joints.push_back(candidate.atom->joint);
    }
  }
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  return joints;
}

// Fast motion holds few sinusoids, and what a controller answers is little here.
std::vector<std::shared_ptr<const Recipe>> byWholeTorque(
    const std::vector<std::shared_ptr<const Recipe>>& recipes) {
  std::vector<std::shared_ptr<const Recipe>> changed;
  for (const auto& recipe : recipes) {
    Recipe copy = *recipe;
    copy.by_asked_torque = false;
    changed.push_back(std::make_shared<const Recipe>(std::move(copy)));
  }
  return changed;
}

}  // namespace

double leastLateness_s(std::span<const Recording> recordings) {
  const auto slowest = std::min_element(recordings.begin(), recordings.end(),
                                        [](const auto& a, const auto& b) { return a.rate_Hz < b.rate_Hz; });
  double periods = late_drive::kLeastPeriods;
  if (slowest->torque_timing_assumed && slowest->torque_timing != TorqueTiming::kHeld) {
    // The motion told that it was not held, which a drive that is late by that much contradicts.
    periods += slowest->torque_timing == TorqueTiming::kSampled ? 0.5 : 1.0;
  }
  return periods / slowest->rate_Hz;
}

std::vector<LateDrive> findLateDrives(std::span<const Recording> recordings,
                                      const model::ModelDescription& explained, std::span<const int> joints,
                                      std::span<const RestingJoint> resting, const FitOptions& fit_options,
                                      const SelectionOptions& selection) {
  Dataset data(recordings, kFast);
  data.leaveOutRest(resting);
  if (data.isStatic()) {
    return {};
  }
  const std::vector<int> clean = undisturbed(data, explained, joints);
  if (clean.empty()) {
    return {};
  }
  ModelFitter fitter(data, explained, fit_options);
  fitter.setRedundancy(redundancy(data, fitter.nominal(), selection.seed));
  const ModelFit nominal = fitter.nominal();
  const std::vector<std::string> kinds{"actuator_delay", "actuator_lag"};
  const std::vector<double> no_friction(static_cast<std::size_t>(data.joints()), 0.0);
  auto all = byWholeTorque(recipes(data, explained.mechanism, kinds, {}, no_friction));
  std::erase_if(all, [&](const auto& recipe) {
    return std::find(clean.begin(), clean.end(), recipe->joint) == clean.end();
  });
  std::vector<LateDrive> late;
  for (const int joint : promising(fitter, nominal, recipeAtoms(fitter, all))) {
    auto considered = all;
    std::erase_if(considered, [joint](const auto& recipe) { return recipe->joint != joint; });
    // One a drive: two delays are one.
    SelectionOptions one = selection;
    one.most_effects = 1;
    const Selection found = select(fitter, recipeAtoms(fitter, considered), nominal, one);
    if (found.fit.terms.size() == nominal.terms.size()) {
      continue;
    }
    const Term& term = found.fit.terms.back();
    const std::vector<double> parameters = ModelFitter::effectParameters(term);
    if (jointRms(data, found.fit.residual, joint) >
        std::sqrt(1.0 - late_drive::kMaterial) * jointRms(data, nominal.residual, joint)) {
      continue;
    }
    const Eigen::MatrixXd covariance =
        parameterCovariance(data, found.fit, selection.replicates, selection.seed);
    late.push_back({.effect = {.kind = term.recipe->kind, .joint = joint, .parameters = parameters},
                    .estimate = estimates(found.fit, covariance, found.fit.terms.size() - 1).front(),
                    .evidence = found.evidence.back()});
  }
  return late;
}

}  // namespace patella::diagnose
