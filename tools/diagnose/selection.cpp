#include "tools/diagnose/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/candidate.hpp"
#include "tools/diagnose/gates.hpp"
#include "tools/diagnose/ranking.hpp"
#include "tools/diagnose/relations.hpp"
#include "tools/diagnose/restatement.hpp"

namespace patella::diagnose {
namespace {

/// Candidates of a step that are fitted in full: the best of the screening, so many at most, as long as what
/// their columns explain comes near the best fit so far.
constexpr std::size_t kFittedCandidates = 10;
constexpr double kNearBest = 0.3;
/// Of what the found effect's columns explain, what those of a rival must, to be fitted in full.
constexpr double kNearRival = 0.35;
/// Effects within this much of −2 log posterior of each other explain the data equally well.
constexpr double kRivalMargin = 6.0;
/// The same without regard to the number of parameters: what explains no less is no worse an answer for
/// having more of them, which its physics may have fixed.
constexpr double kAsWell = 2.7;
/// The same as a share of what was found explains: where that is much, small faults of any model, which grow
/// with it, count for more than noise.
constexpr double kNoDifference = 0.005;
/// The same for a delay and a lag of one drive, which real ones have a little of both: four standard
/// deviations.
constexpr double kSameTiming = 16.0;
/// An effect that contains another always explains as much. It is a rival only where each parameter that it
/// has beyond the other explains more than one in twenty would by chance.
constexpr double kNestedEvidence = 3.84;
/// Of the mean square that is left of a joint's torque, what an effect has to explain: less is nothing that
/// anyone would miss, however sure it is.
constexpr double kLeastShare = 0.03;
/// Squared standard deviations. Damping that the model declares, or its masses, may have moved to make up for
/// what is missing, so that little is left to explain.
constexpr double kMaterialRelief = 4.0;
/// Of Akaike's criterion: a rival so much behind another has less than a seventh of its support.
constexpr double kPredictsLess = 4.0;
constexpr double kLeastStability = 0.8;
constexpr double kCrossValidationErrors = 1.5;
constexpr int kRivalReplicates = 99;
/// Of a found torque's size, by how much one that contains it may differ within its 95 % interval, and the
/// found one still be the only answer.
constexpr double kMaterialDoubt = 0.25;
constexpr double kWithin95 = 2.0;
/// Of what Stribeck's friction explains, the share from which on dry friction may be all there is.
constexpr double kNearlyAll = 0.85;

class Selector {
 public:
  Selector(ModelFitter& fitter, const Atoms& atoms, const ModelFit& nominal, const SelectionOptions& options)
      : fitter_(fitter), atoms_(atoms), options_(options), cost_(parameterCost(nominal)) {
    result_.fit = nominal;
    result_.evidence.resize(nominal.terms.size());
  }

  Selection run() {
    for (int step = 0; step < options_.most_effects && forward(); ++step) {
      backward();
      report(static_cast<double>(step + 1) / options_.most_effects);
    }
    restate(fitter_, atoms_, unit_, result_);
    findRivals();
    return std::move(result_);
  }

 private:
  void report(double fraction) const {
    if (options_.progress) {
      options_.progress(fraction);
    }
  }

  bool forward() {
    const ModelFit& current = result_.fit;
    const Screening screening(
        fitter_.data(), current, atoms_.items, atoms_.columns,
        {.replicates = options_.replicates, .seed = options_.seed + 7919 * result_.steps.size()});
    std::vector<Candidate> candidates = rank(atoms_, screening, cost_);
    std::erase_if(candidates,
                  [&](const Candidate& candidate) { return isContained(*candidate.atom->recipe); });
    const auto statistic = [cost = cost_](double gain, int dimensions) { return gain - cost * dimensions; };
    std::vector<double> chance = screening.chance(statistic);
    std::sort(chance.begin(), chance.end());
    const auto place =
        static_cast<std::size_t>((1.0 - options_.family_wise_p) * static_cast<double>(chance.size() - 1));
    const double threshold = chance[place];

    Candidate* best = fitBest(current, candidates);
    double p_value = 1.0;
    if (best != nullptr) {
      p_value = exceedance(chance, best->margin);
      best->refused_because = gate(*best, p_value);
    }
    SelectionStep step = describeStep(candidates, threshold, cost_);
    step.p_value = p_value;
    const bool accepted = best != nullptr && best->refused_because.empty();
    if (accepted) {
      step.ranking[static_cast<std::size_t>(best - candidates.data())].accepted = true;
      step.accepted = best->atom->label;
      accept(*best, p_value);
    }
    std::stable_sort(step.ranking.begin(), step.ranking.end(),
                     [](const auto& a, const auto& b) { return a.gain > b.gain; });
    result_.steps.push_back(std::move(step));
    return accepted;
  }

  // There already, or a special case of what is there.
  bool isContained(const Recipe& recipe) const {
    return std::any_of(result_.fit.terms.begin(), result_.fit.terms.end(), [&](const Term& term) {
      return !term.declared && (isSame(*term.recipe, recipe) || shapesTheSame(*term.recipe, recipe) ||
                                (term.recipe->kind != recipe.kind && contains(*term.recipe, recipe)));
    });
  }

  // Fits the most promising candidates, the first of the list, and returns the best that no gate refuses.
  Candidate* fitBest(const ModelFit& current, std::vector<Candidate>& candidates) {
    Candidate* best = nullptr;
    for (std::size_t i = 0; i < std::min(kFittedCandidates, candidates.size()); ++i) {
      Candidate& candidate = candidates[i];
      if (!candidate.refused_because.empty()) {
        break;
      }
      if (best != nullptr && candidate.score < kNearBest * (current.objective - best->fit->objective)) {
        break;
      }
      fitCandidate(fitter_, current, cost_, candidate);
      if (candidate.refused_because.empty() && (best == nullptr || better(candidate, *best))) {
        best = &candidate;
      }
    }
    return best;
  }

  // Two candidates for the same data are compared under the noise of the one that leaves less.
  bool better(const Candidate& a, const Candidate& b) const {
    const double unit = a.fit->objective < b.fit->objective ? a.unit : b.unit;
    return a.fit->objective + unit * cost_ * parametersInUse(*a.fit) <
           b.fit->objective + unit * cost_ * parametersInUse(*b.fit);
  }

  // Of the mean square that is left of a joint's torque, the largest share that goes.
  double shareOf(const ModelFit& larger) const {
    const Eigen::Index rows = fitter_.data().rows();
    double share = 0.0;
    for (int joint = 0; joint < fitter_.data().joints(); ++joint) {
      const double before = result_.fit.residual.segment(joint * rows, rows).squaredNorm();
      const double after = larger.residual.segment(joint * rows, rows).squaredNorm();
      share = std::max(share, before > 0.0 ? 1.0 - after / before : 0.0);
    }
    return share;
  }

  // What was known beforehand speaks against a fit by so many squared standard deviations less.
  double reliefOf(const ModelFit& larger) const {
    return (result_.fit.prior_residual.squaredNorm() - larger.prior_residual.squaredNorm()) /
           std::pow(larger.prior_scale, 2);
  }

  std::string gate(const Candidate& candidate, double p_value) const {
    if (options_.gates.share && shareOf(*candidate.fit) < kLeastShare &&
        reliefOf(*candidate.fit) < kMaterialRelief) {
      return "too little";
    }
    if (options_.gates.chance && p_value >= options_.family_wise_p) {
      return "chance";
    }
    if (options_.gates.cross_validation) {
      const CrossValidation validated = crossValidate(result_.fit, *candidate.fit);
      if (!validated.almost_everywhere &&
          validated.gain <= kCrossValidationErrors * validated.standard_error) {
        return "cross-validation";
      }
    }
    if (options_.gates.stability &&
        stability(result_.fit, *candidate.fit, candidate.unit * (candidate.gain - candidate.margin),
                  options_.seed) < kLeastStability) {
      return "stability";
    }
    return {};
  }

  // Evidence follows its term; what the new one replaced goes.
  void accept(Candidate& best, double p_value) {
    std::vector<Evidence> evidence;
    for (std::size_t t = 0; t < result_.fit.terms.size(); ++t) {
      if (!replaces(*best.atom->recipe, result_.fit.terms[t])) {
        evidence.push_back(result_.evidence[t]);
      }
    }
    evidence.push_back({.p_value = p_value, .gain = best.gain, .rivals = {}});
    // What is left now is nearer to the noise: weighted by it, everything is fitted once more.
    const Eigen::VectorXd residual = best.fit->residual;
    fitter_.setRedundancy(redundancy(fitter_.data(), *best.fit, kUnitSeed));
    result_.fit = fitter_.fit(std::move(*best.fit), Weighting(fitter_.data(), residual));
    result_.evidence = std::move(evidence);
    unit_ = best.unit;
  }

  ModelFit without(std::size_t term) {
    return fitter_.fit(withoutTerm(result_.fit, term), *result_.fit.weighting);
  }

  // Drops what later additions have made superfluous.
  void backward() {
    for (std::size_t t = 0; t < result_.fit.terms.size();) {
      const Term& term = result_.fit.terms[t];
      if (term.declared || t + 1 == result_.fit.terms.size()) {
        ++t;
        continue;
      }
      ModelFit smaller = without(t);
      const double gain = (smaller.objective - result_.fit.objective) / unit_;
      if (gain < cost_ * (parameters(result_.fit) - parameters(smaller))) {
        const std::size_t back = term.replaced.size();
        result_.fit = std::move(smaller);
        result_.evidence.erase(result_.evidence.begin() + static_cast<std::ptrdiff_t>(t));
        result_.evidence.insert(result_.evidence.begin(), back, Evidence{});
        t += back;
      } else {
        result_.evidence[t].gain = gain;
        ++t;
      }
    }
  }

  // Effects that would do as well in a found one's place.
  void findRivals() {
    for (std::size_t t = 0; t < result_.fit.terms.size(); ++t) {
      if (result_.fit.terms[t].declared) {
        continue;
      }
      const ModelFit smaller = without(t);
      const double size = parametersInUse(result_.fit) - parametersInUse(smaller);
      result_.evidence[t].gain = (smaller.objective - result_.fit.objective) / unit_;
      const double full_margin = result_.evidence[t].gain - cost_ * size;
      const std::string own = result_.fit.terms[t].recipe->label();
      const Screening screening(fitter_.data(), smaller, atoms_.items, atoms_.columns,
                                {.replicates = kRivalReplicates, .seed = options_.seed});
      std::vector<Candidate> candidates = rank(atoms_, screening, cost_);
      const auto itself = std::find_if(candidates.begin(), candidates.end(),
                                       [&](const Candidate& c) { return c.atom->label == own; });
      const double own_score = itself == candidates.end() ? 0.0 : itself->score;
      std::erase_if(candidates, [&](const Candidate& c) {
        return c.atom->label == own || c.score < kNearRival * own_score;
      });
      std::vector<const Candidate*> rivals;
      fitBest(smaller, candidates);
      const Candidate* simpler = nullptr;
      const Candidate* wider = nullptr;
      for (const Candidate& candidate : candidates) {
        if (candidate.fit && !unphysical(candidate.refused_because) &&
            (rivalMargin(candidate, smaller) > full_margin - kRivalMargin ||
             candidate.fit->objective <
                 result_.fit.objective +
                     std::max((areLate(*candidate.atom->recipe, *result_.fit.terms[t].recipe) ? kSameTiming
                                                                                              : kAsWell),
                              kNoDifference * result_.evidence[t].gain) *
                         unit_) &&
            !decidedByNesting(candidate, smaller, t)) {
          rivals.push_back(&candidate);
        } else if (candidate.fit && isNearlyAll(candidate, smaller, t)) {
          simpler = &candidate;
        } else if (candidate.fit && rivals.empty() && notExcluded(candidate, t) &&
                   (wider == nullptr || predicts(candidate) > predicts(*wider))) {
          wider = &candidate;
        }
      }
      const Candidate* other = simpler != nullptr ? simpler : wider;
      if (rivals.empty() && other != nullptr) {
        rivals.push_back(other);
      }
      dropOutdone(rivals, *result_.fit.terms[t].recipe);
      for (const Candidate* rival : rivals) {
        auto& labels = result_.evidence[t].rivals;
        if (std::find(labels.begin(), labels.end(), rival->atom->label) == labels.end()) {
          labels.push_back(rival->atom->label);
        }
      }
    }
  }

  // Of two effects of which one contains the other, the information criterion has chosen.
  bool decidedByNesting(const Candidate& rival, const ModelFit& smaller, std::size_t term) const {
    const Recipe& own = *result_.fit.terms[term].recipe;
    if (contains(own, *rival.atom->recipe)) {
      return true;
    }
    const double more = parameters(*rival.fit) - parameters(result_.fit);
    const double gain = (smaller.objective - rival.fit->objective) / unit_ - result_.evidence[term].gain;
    return contains(*rival.atom->recipe, own) && gain < kNestedEvidence * more;
  }

  // Of rivals of which one contains the other, evidence chooses as above; of those that contain what was
  // found, one is named, which would predict best; of any, those stay that would predict nearly as well as
  // the best of them.
  void dropOutdone(std::vector<const Candidate*>& rivals, const Recipe& found) const {
    const auto outdone = [&](const Candidate* rival, const Candidate* other) {
      const double gain = (other->fit->objective - rival->fit->objective) / unit_;
      const double more = parameters(*rival->fit) - parameters(*other->fit);
      const Recipe& own = *rival->atom->recipe;
      const Recipe& its = *other->atom->recipe;
      if (contains(own, its) || contains(its, own) || approaches(own, its)) {
        return gain < kNestedEvidence * more;
      }
      if (contains(own, found) && contains(its, found)) {
        return predicts(*rival) < predicts(*other);
      }
      return predicts(*rival) < predicts(*other) - kPredictsLess * unit_;
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
  bool isNearlyAll(const Candidate& rival, const ModelFit& smaller, std::size_t term) const {
    const Recipe& own = *result_.fit.terms[term].recipe;
    return own.kind == "stribeck_friction" && rival.atom->recipe->kind == "coulomb_friction" &&
           rival.atom->recipe->joint == own.joint && !unphysical(rival.refused_because) &&
           smaller.objective - rival.fit->objective >
               kNearlyAll * (smaller.objective - result_.fit.objective);
  }

  // In the unit of what was found, as rivals explain the same part of the data.
  double rivalMargin(const Candidate& rival, const ModelFit& smaller) const {
    return (smaller.objective - rival.fit->objective) / unit_ -
           cost_ * (parametersInUse(*rival.fit) - parametersInUse(smaller));
  }

  // Akaike's criterion: how well a rival would predict, as nobody claims that the data prove it.
  double predicts(const Candidate& rival) const {
    return -rival.fit->objective - 2.0 * unit_ * parametersInUse(*rival.fit);
  }

  // Whether the torque of an effect that contains the found one may well be another: too little is said of
  // what it has beyond.
  bool notExcluded(const Candidate& rival, std::size_t term) {
    const ModelFit& fit = *rival.fit;
    const Recipe& own = *result_.fit.terms[term].recipe;
    if (!contains(*rival.atom->recipe, own) || unphysical(rival.refused_because)) {
      return false;
    }
    const Eigen::MatrixXd covariance =
        parameterCovariance(fitter_.data(), fit, kRivalReplicates, options_.seed);
    const Eigen::Index first = fit.offset.back();
    const Eigen::Index count = fit.tangent.cols() - first;
    const Eigen::MatrixXd slope = fit.tangent.rightCols(count);
    const Eigen::LDLT<Eigen::MatrixXd> root(covariance.bottomRightCorner(count, count));
    const Eigen::MatrixXd spread = slope *
                                   (root.transpositionsP().transpose() * Eigen::MatrixXd(root.matrixL())) *
                                   root.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(spread.transpose() * spread).eigenvalues().maxCoeff();
    const double found = fitter_.torque(result_.fit.terms[term]).squaredNorm();
    return kWithin95 * std::sqrt(largest) > kMaterialDoubt * std::sqrt(found);
  }

  ModelFitter& fitter_;
  const Atoms& atoms_;
  const SelectionOptions& options_;
  double cost_;
  double unit_ = 1.0;  ///< of the last accepted candidate
  Selection result_;
};

}  // namespace

Selection select(ModelFitter& fitter, const Atoms& atoms, const ModelFit& nominal,
                 const SelectionOptions& options) {
  return Selector(fitter, atoms, nominal, options).run();
}

Selection withoutTerm(ModelFitter& fitter, const Selection& selection, std::size_t term) {
  Selection smaller = selection;
  smaller.fit = fitter.fit(withoutTerm(selection.fit, term), *selection.fit.weighting);
  smaller.evidence.erase(smaller.evidence.begin() + static_cast<std::ptrdiff_t>(term));
  // Declared terms that come back stand first.
  smaller.evidence.insert(smaller.evidence.begin(), selection.fit.terms[term].replaced.size(), Evidence{});
  return smaller;
}

}  // namespace patella::diagnose
