#include "tools/diagnose/evidence/decision.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/evidence/asked_motion.hpp"
#include "tools/diagnose/evidence/inference.hpp"
#include "tools/diagnose/evidence/thresholds.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"

namespace patella::diagnose::evidence {
namespace {

/// Standard deviations of a 95 % interval.
constexpr double kInterval = 1.96;
constexpr double kEvaluation_Hz = 250.0;

// By linear propagation.
std::vector<ParameterEstimate> estimatesOf(const Candidate& effect, const Posterior& posterior,
                                           Eigen::Index first) {
  constexpr double kStep = 0.1;  // of a standard deviation
  const Eigen::Index n = effect.count();
  std::vector<double> c(posterior.mean.data() + first, posterior.mean.data() + first + n);
  const std::vector<double> at = effect.family->parameters(c, effect.nu);
  Eigen::MatrixXd slope(static_cast<Eigen::Index>(at.size()), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double step = kStep * std::sqrt(posterior.covariance(first + k, first + k));
    const auto moved = [&](double by) {
      std::vector<double> coefficients = c;
      coefficients[static_cast<std::size_t>(k)] += by;
      return effect.family->parameters(coefficients, effect.nu);
    };
    const std::vector<double> above = moved(step), below = moved(-step);
    for (std::size_t p = 0; p < at.size(); ++p) {
      slope(static_cast<Eigen::Index>(p), k) = (above[p] - below[p]) / (2.0 * step);
    }
  }
  const Eigen::MatrixXd covariance =
      slope * posterior.covariance.block(first, first, n, n) * slope.transpose();
  const auto& described = model::findEffect(effect.family->kind)->parameters;
  std::vector<ParameterEstimate> estimates;
  for (std::size_t p = 0; p < at.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    const double half = kInterval * std::sqrt(covariance(row, row));
    if (half > 0.0) {
      estimates.push_back(
          {.name = std::string(described[p].name), .value = at[p], .ci95 = {at[p] - half, at[p] + half}});
    }
  }
  return estimates;
}

// "kind" on the finding's own joint, "kind@2" elsewhere.
std::string asAlternative(const std::string& label, int joint) {
  const std::string own = "@" + std::to_string(joint + 1);
  return label.ends_with(own) ? label.substr(0, label.size() - own.size()) : label;
}

EffectFinding findingOf(const Inference& inference, const Explanation& best, std::size_t e) {
  const Candidate& effect = best.effects[e];
  EffectFinding finding{
      .kind = effect.family->kind,
      .joint = effect.family->joint,
      .parameters = estimatesOf(effect, best.posterior, inference.firstCoefficient(best, e)),
      .gain = best.score - inference.plain().score,
      .indistinguishable_from = {},
      .replaces = {},
      .separating_motion = {},
  };
  for (const std::string& label : best.equivalent[e]) {
    finding.indistinguishable_from.push_back(asAlternative(label, finding.joint));
  }
  return finding;
}

// The group of other functions that holds most, where together they hold a material share of what was
// missing.
std::vector<Dependence> restOf(const Inference& inference, const Explanation& best) {
  double share = 0.0;
  for (const Inference::Left& left : inference.left(best)) {
    const double noise = left.noise_Nm * left.noise_Nm;
    const double missing = std::max(left.target_Nm * left.target_Nm - noise, noise);
    share = std::max(share, left.other_Nm / std::sqrt(missing));
  }
  if (share < threshold::kMaterialShare || inference.structure(best) < threshold::kLeastStructure) {
    return {};
  }
  Dependence rest;
  for (std::size_t g = 0; g < inference.other().groups.size(); ++g) {
    const double size_Nm = best.posterior.weights[g].norm();
    if (size_Nm > rest.explained_Nm) {
      const OtherGroup& group = inference.other().groups[g];
      rest = {.joint = group.joint, .variable = group.variables, .explained_Nm = size_Nm};
    }
  }
  return {rest};
}

struct Prepared {
  Dataset data;
  Dataset asked;
};

Prepared prepare(std::span<const Recording> recordings, bool pushed) {
  std::vector<Recording> used(recordings.begin(), recordings.end());
  // Sinusoids are differentiated without noise, so that the band may reach as far as effects do.
  const double band_Hz = pushed ? DatasetOptions{}.band_Hz : motionBand_Hz(recordings);
  if (pushed) {
    for (Recording& recording : used) {
      cutToAskedMotion(recording, band_Hz);
    }
  }
  const DatasetOptions options{.evaluation_rate_Hz = kEvaluation_Hz, .band_Hz = band_Hz};
  Dataset data(used, options);
  if (pushed) {
    for (Recording& recording : used) {
      keepAskedMotion(recording, band_Hz);
    }
  }
  return {.data = std::move(data), .asked = Dataset(used, options)};
}

}  // namespace

Diagnosis decide(std::span<const Recording> recordings, const model::ModelDescription& model,
                 const DecisionOptions& options) {
  const Prepared prepared = prepare(recordings, !options.person_Nm.empty());
  Inference inference(prepared.data, prepared.asked, model, recordedChannels(recordings),
                      options.nominal_tolerance,
                      knownNoise_Nm(recordings, model::makeModel(model).mechanism(), prepared.data.band_Hz(),
                                    options.person_Nm));
  const Explanation best = inference.search();
  Diagnosis result;
  result.extended = inference.describe(best);
  Found found;
  for (std::size_t e = 0; e < best.effects.size(); ++e) {
    const Family& family = *best.effects[e].family;
    if (family.isNamed()) {
      found.effects = true;
      result.effects.push_back(findingOf(inference, best, e));
    } else if (family.variables.empty()) {
      found.runaway = true;
    } else {
      result.unexplained.push_back({.joint = family.joint, .variable = family.variables});
    }
  }
  for (Dependence& rest : restOf(inference, best)) {
    result.unexplained.push_back(std::move(rest));
  }
  found.functions = !result.unexplained.empty();
  const std::vector<JointRest> rests = inference.rests(best);
  result.verdict = verdictOf(found, rests);
  for (std::size_t j = 0; j < rests.size(); ++j) {
    result.noise_floor_Nm.push_back(rests[j].noise_Nm);
    if (rests[j].exceeds(allowedRest(found))) {
      result.unexplained.push_back(
          {.joint = static_cast<int>(j), .variable = "", .explained_Nm = rests[j].structure_Nm()});
    }
  }
  return result;
}

}  // namespace patella::diagnose::evidence
