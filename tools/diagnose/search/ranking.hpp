// Candidates of a step of the search, the most promising first, and what each is worth when it is fitted.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/diagnose/search/screening.hpp"

namespace patella::diagnose {

/// Number of a fit's parameters. One of which something is known beforehand counts by the share of a free
/// one's cost, log n, that its evidence takes off: half the logarithm of how much better the data know it
/// (MacKay, Information Theory, Inference, and Learning Algorithms, 28.1), at twice the scale.
double parameters(const ModelFit& fit);

/// The same without coefficients that rest at zero, where physics allows no less: of two fits that both stand
/// up, the one that says less is the simpler.
double parametersInUse(const ModelFit& fit);

/// Cost of a parameter in −2 log-likelihood (Bayesian information criterion).
double parameterCost(const ModelFit& fit);

/// The same draws for all candidates, so that they are compared under the same luck.
inline constexpr std::uint64_t kUnitSeed = 20011;

struct Candidate {
  const Atom* atom = nullptr;
  const Screened* screened = nullptr;
  double score = 0.0;  ///< screened gain less the cost of its parameters
  std::optional<ModelFit> fit;
  double gain = 0.0;  ///< fall of the objective in units of chance under the candidate's own noise
  double unit = 1.0;  ///< that unit
  double margin =
      -std::numeric_limits<double>::infinity();  ///< gain of the full fit less the cost of its parameters
  std::string refused_because;
};

/// Refused for a reason that has nothing to do with how much it would explain.
bool unphysical(const std::string& refusal);

/// The best point of the grid for each recipe, best recipe first; what physics refuses comes last: it is
/// shown, not fitted. A parameter costs `cost`.
std::vector<Candidate> rank(const Atoms& atoms, const Screening& screening, double cost);

/// Fits a candidate beside what is there already, and refuses it where physics or its cost does.
void fitCandidate(ModelFitter& fitter, const ModelFit& current, double cost, Candidate& candidate);

/// Fits the most promising candidates, the first of the list, and returns the best that neither physics nor
/// its cost refuses; nullptr where there is none.
Candidate* fitBest(ModelFitter& fitter, const ModelFit& current, double cost,
                   std::vector<Candidate>& candidates);

/// `threshold` is on the gain less the cost of its parameters; shown is the gain that each candidate has to
/// reach.
SelectionStep describeStep(const std::vector<Candidate>& candidates, double threshold, double cost);

}  // namespace patella::diagnose
