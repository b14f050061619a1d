// How an inference looks for the best explanation: add, drop, exchange, move shapes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/evidence/inference.hpp"
#include "tools/diagnose/evidence/thresholds.hpp"

namespace patella::diagnose::evidence {
namespace {

/// Kinds that are fitted in full at each step, of the best by what their columns would add at fixed levels.
constexpr std::size_t kLookedAt = 8;
constexpr std::size_t kExchangedFor = 4;
constexpr std::size_t kMostEffects = 6;
constexpr int kRounds = 10;
constexpr int kFewRounds = 4;
/// Scale of other functions at which they are as good as absent.
constexpr double kAbsent = 1e-10;
/// A screened candidate is looked at if it makes things worse by no more than this, nats.
constexpr double kWorthALook = -3.0;

bool holds(const std::vector<std::string>& kinds, const std::string& kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

// The effects with one more, without those of which it is a form.
std::vector<Candidate> together(const std::vector<Candidate>& effects, const Candidate& added) {
  std::vector<Candidate> result;
  for (const Candidate& effect : effects) {
    const Family& one = *effect.family;
    const Family& other = *added.family;
    const bool related =
        one.joint == other.joint && (holds(other.contains, one.kind) || holds(one.contains, other.kind));
    if (effect.label() != added.label() && !related) {
      result.push_back(effect);
    }
  }
  result.push_back(added);
  return result;
}

std::vector<Candidate> without(std::vector<Candidate> effects, std::size_t index) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(index));
  return effects;
}

}  // namespace

Explanation Inference::search() {
  constexpr int kCounts = 3;  // what was missing may have hidden how little is left
  Explanation best = plain_;
  for (int count = 0; count < kCounts; ++count) {
    countLooks(best);
    best = grown(withoutNeedless(explain(best.effects, best.posterior.levels, kRounds), 0));
  }
  findEquivalent(best);
  return best;
}

// Effects are added while they make the recordings likelier.
Explanation Inference::grown(Explanation best) {
  while (best.effects.size() < kMostEffects) {
    Explanation next = withOneMore(best);
    if (next.score < best.score + threshold::kLeastGain) {
      break;
    }
    best = exchanged(withoutNeedless(std::move(next), 1));
    renew(best);
  }
  return best;
}

Explanation Inference::withOneMore(const Explanation& best) {
  Explanation next = best;
  for (const Candidate& candidate : screened(best, kLookedAt)) {
    Explanation trial = explain(together(best.effects, candidate), best.posterior.levels, kRounds);
    if (trial.possible && trial.score > next.score) {
      next = std::move(trial);
    }
  }
  return next.score > best.score ? refined(std::move(next)) : next;
}

// What has become needless goes; the newest `kept` are not looked at.
Explanation Inference::withoutNeedless(Explanation best, std::size_t kept) const {
  for (std::size_t e = 0; e + kept < best.effects.size();) {
    Explanation trial = explain(without(best.effects, e), best.posterior.levels, kRounds);
    if (trial.possible && trial.score > best.score - threshold::kLeastGain) {
      best = std::move(trial);
      e = 0;
    } else {
      ++e;
    }
  }
  return best;
}

// What another effect explains better takes the place of an earlier one.
Explanation Inference::exchanged(Explanation best) {
  constexpr double kWorthIt = 1.0;  // nats, lest two equal ones take turns
  for (std::size_t e = 0; e + 1 < best.effects.size(); ++e) {
    const std::vector<Candidate> others = without(best.effects, e);
    Explanation better = best;
    for (const Candidate& candidate :
         screened(explain(others, best.posterior.levels, kRounds), kExchangedFor)) {
      Explanation trial = explain(together(others, candidate), best.posterior.levels, kRounds);
      if (trial.possible && trial.score > better.score + kWorthIt) {
        better = std::move(trial);
      }
    }
    if (better.score > best.score) {
      best = refined(std::move(better));
    }
  }
  return best;
}

void Inference::findEquivalent(Explanation& best) {
  constexpr double kMayBecomeEqual = 10.0;  // nats that moving the shapes may bring
  best.equivalent.assign(best.effects.size(), {});
  for (std::size_t e = 0; e < best.effects.size(); ++e) {
    const std::vector<Candidate> others = without(best.effects, e);
    for (const Candidate& candidate : screened(explain(others, best.posterior.levels, kRounds), kLookedAt)) {
      if (candidate.label() == best.effects[e].label() || holds(best.equivalent[e], candidate.label())) {
        continue;
      }
      Explanation trial = explain(together(others, candidate), best.posterior.levels, kRounds);
      if (trial.effects.size() != best.effects.size() || !trial.possible ||
          trial.score < best.score - kMayBecomeEqual) {
        continue;
      }
      if (refined(std::move(trial)).score > best.score - threshold::kSameEvidence) {
        best.equivalent[e].push_back(candidate.label());
      }
    }
  }
}

double Inference::gainOf(const Candidate& candidate, Eigen::MatrixXd information,
                         const Eigen::VectorXd& product) const {
  double cost = std::log(candidate.family->choices);
  for (Eigen::Index k = 0; k < candidate.count(); ++k) {
    information(k, k) += 1.0 / (sdOf(candidate, k) * sdOf(candidate, k));
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  const Eigen::VectorXd estimate = factor.solve(product);
  for (Eigen::Index k = 0; k < candidate.count(); ++k) {
    cost += std::log(sdOf(candidate, k) * factor.matrixLLT()(k, k));
    if (candidate.family->nonnegative[static_cast<std::size_t>(k)] && estimate[k] <= 0.0) {
      return -std::numeric_limits<double>::infinity();
    }
  }
  const double gain = 0.5 * product.dot(estimate) - cost;
  return std::isfinite(gain) ? gain : -std::numeric_limits<double>::infinity();
}

// The best form of each of the kinds that would add most: with other functions as they are, which may hold
// what an effect explains, and without them.
std::vector<Candidate> Inference::screened(const Explanation& at, std::size_t most) const {
  std::vector<const Candidate*> all;
  std::vector<Eigen::Index> columns;
  for (const auto* list : {&lasting_, &changing_}) {
    for (const Candidate& candidate : *list) {
      all.push_back(&candidate);
      for (Eigen::Index k = 0; k < candidate.count(); ++k) {
        columns.push_back(candidate.first + k);
      }
    }
  }
  Levels absent = at.posterior.levels;
  std::fill(absent.other.begin(), absent.other.end(), kAbsent);
  std::vector<Candidate> chosen;
  std::set<const Candidate*> taken;
  for (const Levels& levels : {at.posterior.levels, absent}) {
    const auto found = evidence_->beside(parametersOf(at.effects), target_, levels, columns);
    std::vector<std::pair<double, std::size_t>> gains;
    Eigen::Index first = 0;
    for (std::size_t c = 0; c < all.size(); ++c) {
      const Eigen::Index n = all[c]->count();
      gains.emplace_back(
          gainOf(*all[c], found.information.block(first, first, n, n), found.product.segment(first, n)), c);
      first += n;
    }
    std::sort(gains.rbegin(), gains.rend());
    std::set<std::string> forms;
    for (const auto& [gain, c] : gains) {
      if (forms.size() == most || gain < kWorthALook) {
        break;
      }
      if (forms.insert(all[c]->label() + all[c]->family->variant).second && taken.insert(all[c]).second) {
        chosen.push_back(*all[c]);
      }
    }
  }
  return chosen;
}

// Gauss and Newton over the shapes ν of all effects, at the explanation's levels.
Explanation Inference::refined(Explanation explanation) {
  constexpr int kSteps = 4;
  constexpr double kWorthIt = 0.05;  // nats
  for (int step = 0; step < kSteps; ++step) {
    std::vector<Candidate> moved = explanation.effects;
    if (!moveShapes(explanation, moved)) {
      break;
    }
    Explanation trial = explain(std::move(moved), explanation.posterior.levels, kFewRounds);
    if (!trial.possible || trial.score < explanation.score + kWorthIt) {
      break;
    }
    explanation = std::move(trial);
  }
  return explanation;
}

// One step; false where no effect has a shape.
bool Inference::moveShapes(const Explanation& explanation, std::vector<Candidate>& moved) {
  constexpr double kLongest = 0.25;     // of a range, a step
  constexpr double kUsual = 0.3;        // of a range, its standard deviation beforehand
  constexpr double kDifference = 2e-3;  // of a range, over which derivatives are taken
  std::vector<Parameter> parameters = parametersOf(moved);
  const std::size_t fixed = parameters.size();
  for (std::size_t e = 0; e < moved.size(); ++e) {
    const Family& family = *moved[e].family;
    const Eigen::VectorXd c =
        explanation.posterior.mean.segment(firstCoefficient(explanation, e), moved[e].count());
    for (std::size_t k = 0; k < family.shape.size(); ++k) {
      const double range = family.shape[k].upper - family.shape[k].lower;
      std::vector<double> nu = moved[e].nu;
      nu[k] +=
          nu[k] + kDifference * range > family.shape[k].upper ? -kDifference * range : kDifference * range;
      const Eigen::VectorXd slope =
          (family.columns(nu) - family.columns(moved[e].nu)) * c / (nu[k] - moved[e].nu[k]);
      parameters.push_back({.column = moments_.append(slope), .sd = kUsual * range});
    }
  }
  if (parameters.size() == fixed) {
    return false;
  }
  const Posterior posterior = evidence_->of(parameters, target_, explanation.posterior.levels, 1);
  auto at = static_cast<Eigen::Index>(fixed);
  for (Candidate& effect : moved) {
    const Family& family = *effect.family;
    for (std::size_t k = 0; k < family.shape.size(); ++k) {
      const auto [lower, upper] = family.shape[k];
      const double longest = kLongest * (upper - lower);
      effect.nu[k] =
          std::clamp(effect.nu[k] + std::clamp(posterior.mean[at++], -longest, longest), lower, upper);
    }
    if (!family.shape.empty()) {
      effect.first = moments_.append(family.columns(effect.nu));
    }
  }
  return true;
}

}  // namespace patella::diagnose::evidence
