#include "tools/diagnose/search/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/exchange.hpp"
#include "tools/diagnose/search/prediction.hpp"
#include "tools/diagnose/search/ranking.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

constexpr int kRivalReplicates = 99;

/// Data shared by the search for rivals of one found effect.
class RivalSearch {
 public:
  RivalSearch(ModelFitter& fitter, const ModelFit& found, const ModelFit& smaller, std::size_t term,
              const RivalOptions& options)
      : fitter_(fitter),
        found_(found),
        smaller_(smaller),
        own_(*found.terms[term].recipe),
        torque_(fitter.torque(found.terms[term])),
        cost_(parameterCost(found)),
        unit_(options.unit),
        seed_(options.seed),
        gain_((smaller.objective - found.objective) / options.unit),
        prediction_(fitter, found, options.heldout) {}

  double gain() const { return gain_; }

  struct Found {
    std::vector<std::string> labels;
    std::optional<ModelFit> better;  ///< with the rival that has more evidence than what was found
  };

  Found find(const Atoms& atoms) {
    const Screening screening(fitter_.data(), smaller_, atoms,
                              {.replicates = kRivalReplicates, .seed = seed_});
    std::vector<Candidate> candidates = rank(atoms, screening, cost_);
    const std::string own = own_.label();
    const auto itself = std::find_if(candidates.begin(), candidates.end(),
                                     [&](const Candidate& c) { return c.atom->label == own; });
    const double own_score = itself == candidates.end() ? 0.0 : itself->score;
    std::erase_if(candidates, [&](const Candidate& c) {
      return isFound(c.atom->label) || c.score < rivals::kNear * own_score;
    });
    fitBest(fitter_, smaller_, cost_, candidates);
    std::vector<const Candidate*> rivals;
    const Candidate* simpler = nullptr;
    const Candidate* wider = nullptr;
    Found found;
    double most = 0.0;
    for (const Candidate& candidate : candidates) {
      if (candidate.fit && mayStandFirst(candidate) && aheadBy(candidate) > most) {
        most = aheadBy(candidate);
        found.better = candidate.fit;
      }
      if (candidate.fit && doesAsWell(candidate)) {
        if (!isExcluded(candidate)) {
          rivals.push_back(&candidate);
        }
      } else if (candidate.fit && isNearlyAll(candidate)) {
        simpler = &candidate;
      } else if (candidate.fit && rivals.empty() && mayBeWider(candidate) &&
                 (wider == nullptr || predicts(*candidate.fit) > predicts(*wider->fit))) {
        wider = &candidate;
      }
    }
    const Candidate* other = simpler != nullptr ? simpler : wider;
    if (rivals.empty() && other != nullptr) {
      rivals.push_back(other);
    }
    dropOutdone(rivals);
    for (const Candidate* rival : rivals) {
      found.labels.push_back(rival->atom->label);
    }
    return found;
  }

 private:
  bool isFound(const std::string& label) const {
    return std::any_of(found_.terms.begin(), found_.terms.end(),
                       [&](const Term& term) { return !term.declared && term.recipe->label() == label; });
  }

  // Where all evidence is for it, a special case of what was found stands first; another effect, which does
  // as well by the fit, where that is beyond doubt. What contains the found one never does: a person's push,
  // or a drift, is always explained a little better by more parameters. Nor does one of another joint: what
  // is carried from joint to joint are masses, which are known to their tolerance only.
  bool mayStandFirst(const Candidate& rival) {
    const Recipe& its = *rival.atom->recipe;
    if (!rival.refused_because.empty() || its.joint != own_.joint || contains(its, own_) ||
        approaches(its, own_) || approaches(own_, its)) {
      return false;
    }
    return contains(own_, its) ? marginOf(rival) > ownMargin() - rivals::kAlike
                               : doesAsWell(rival) && aheadBy(rival) > rivals::kMargin;
  }

  double ownMargin() const { return gain_ - cost_ * (parametersInUse(found_) - parametersInUse(smaller_)); }

  // Evidence by which a rival is ahead of what was found: of what was fitted, and of what was not.
  double aheadBy(const Candidate& rival) {
    return marginOf(rival) - ownMargin() + prediction_.gain(*rival.fit) / unit_;
  }

  bool doesAsWell(const Candidate& rival) const {
    if (unphysical(rival.refused_because) || decidedByNesting(rival)) {
      return false;
    }
    const double as_well = areAlike(*rival.atom->recipe, own_) ? rivals::kAlike : rivals::kAsWell;
    return marginOf(rival) > ownMargin() - rivals::kMargin ||
           rival.fit->objective < found_.objective + std::max(as_well, rivals::kNoDifference * gain_) * unit_;
  }

  // Whether the held-out part tells apart what the fit does not.
  bool isExcluded(const Candidate& rival) {
    return aheadBy(rival) < -rivals::kAlike && !areAlike(*rival.atom->recipe, own_);
  }

  // The information criterion has chosen between two effects of which one contains the other.
  bool decidedByNesting(const Candidate& rival) const {
    if (contains(own_, *rival.atom->recipe)) {
      return true;
    }
    const double more = parameters(*rival.fit) - parameters(found_);
    const double gain = gainOf(rival) - gain_;
    return contains(*rival.atom->recipe, own_) && gain < rivals::kNestedEvidence * more;
  }

  // Evidence chooses as above where one rival contains the other. Where several contain what was found, the
  // one that would predict best is named. The others stay if they would predict nearly as well as the best.
  void dropOutdone(std::vector<const Candidate*>& rivals) {
    const auto outdone = [&](const Candidate* rival, const Candidate* other) {
      const double gain = (other->fit->objective - rival->fit->objective) / unit_;
      const double more = parameters(*rival->fit) - parameters(*other->fit);
      const Recipe& one = *rival->atom->recipe;
      const Recipe& its = *other->atom->recipe;
      if (contains(one, its) || contains(its, one) || approaches(one, its)) {
        return gain < rivals::kNestedEvidence * more;
      }
      if (contains(one, own_) && contains(its, own_)) {
        return predicts(*rival->fit) < predicts(*other->fit);
      }
      return predicts(*rival->fit) < predicts(*other->fit) - rivals::kPredictsLess * unit_;
    };
    const auto outdoneByAny = [&](const Candidate* rival) {
      return std::any_of(rivals.begin(), rivals.end(), [&](const Candidate* other) {
        return other->atom->recipe->label() != rival->atom->recipe->label() && outdone(rival, other);
      });
    };
    // One by one, so that the last stays.
    for (auto at = rivals.begin();
         (at = std::find_if(rivals.begin(), rivals.end(), outdoneByAny)) != rivals.end();) {
      rivals.erase(at);
    }
  }

  // Whether dry friction alone explains almost what Stribeck's does. Near rest a measured velocity turns
  // round in its own way, and the larger the friction, the more that looks like a peak.
  bool isNearlyAll(const Candidate& rival) const {
    return own_.kind == "stribeck_friction" && rival.atom->recipe->kind == "coulomb_friction" &&
           rival.atom->recipe->joint == own_.joint && !unphysical(rival.refused_because) &&
           gainOf(rival) > rivals::kNearlyAll * gain_;
  }

  // In the unit of what was found, as rivals explain the same part of the data.
  double gainOf(const Candidate& rival) const { return (smaller_.objective - rival.fit->objective) / unit_; }

  double marginOf(const Candidate& rival) const {
    return gainOf(rival) - cost_ * (parametersInUse(*rival.fit) - parametersInUse(smaller_));
  }

  // How well a rival predicts: by Akaike's criterion, as nobody claims that the data prove it, and what was
  // held out.
  double predicts(const ModelFit& fit) {
    return prediction_.gain(fit) - fit.objective - 2.0 * unit_ * parametersInUse(fit);
  }

  // Whether an effect that contains the found one may be the true one: it would predict better, though the
  // evidence is too little to find it, or it has not been excluded. Where its estimate is beyond its range,
  // only the latter counts.
  bool mayBeWider(const Candidate& rival) {
    const std::string& refusal = rival.refused_because;
    return contains(*rival.atom->recipe, own_) && !refusal.starts_with("sign") &&
           ((!unphysical(refusal) && predicts(*rival.fit) > predicts(found_)) || notExcluded(*rival.fit));
  }

  // Whether the torque of a fit's last effect may well be another: too little is said of what it has beyond.
  bool notExcluded(const ModelFit& fit) const {
    const Eigen::MatrixXd covariance = parameterCovariance(fitter_.data(), fit, kRivalReplicates, seed_);
    const Eigen::Index first = fit.offset.back();
    const Eigen::Index count = fit.tangent.cols() - first;
    const Eigen::MatrixXd slope = fit.tangent.rightCols(count);
    const Eigen::LDLT<Eigen::MatrixXd> root(covariance.bottomRightCorner(count, count));
    const Eigen::MatrixXd spread = slope *
                                   (root.transpositionsP().transpose() * Eigen::MatrixXd(root.matrixL())) *
                                   root.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(spread.transpose() * spread).eigenvalues().maxCoeff();
    return rivals::kWithin95 * std::sqrt(largest) > rivals::kMaterialDoubt * torque_.norm();
  }

  ModelFitter& fitter_;
  const ModelFit& found_;
  const ModelFit& smaller_;  ///< without the found effect
  const Recipe& own_;
  Eigen::VectorXd torque_;  ///< of the found effect
  double cost_;
  double unit_;
  std::uint64_t seed_;
  double gain_;  ///< of the found effect
  Prediction prediction_;
};

}  // namespace

bool findRivals(ModelFitter& fitter, const Atoms& atoms, const RivalOptions& options, Selection& selection) {
  std::vector<Evidence> evidence = selection.evidence;
  for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
    if (selection.fit.terms[t].declared) {
      continue;
    }
    const ModelFit smaller = fitter.fit(withoutTerm(selection.fit, t), *selection.fit.weighting);
    RivalSearch search(fitter, selection.fit, smaller, t, options);
    RivalSearch::Found found = search.find(atoms);
    if (found.better && options.heldout != nullptr && options.may_exchange) {
      exchange(fitter, std::move(*found.better), t, selection);
      return true;
    }
    evidence[t].gain = search.gain();
    auto& known = evidence[t].rivals;
    for (const std::string& label : found.labels) {
      if (std::find(known.begin(), known.end(), label) == known.end()) {
        known.push_back(label);
      }
    }
  }
  selection.evidence = std::move(evidence);
  return false;
}

}  // namespace patella::diagnose
