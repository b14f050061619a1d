// Promises of the search for rivals: what the fit cannot tell apart, the held-out part may.
#include "tools/diagnose/search/rivals.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/search/exchange.hpp"
#include "tools/diagnose/search/prediction.hpp"

namespace patella::diagnose {
namespace {

constexpr double kNoise_Nm = 0.3;
constexpr double kSmoothing_rad_s = 0.05;
constexpr double kBias_Nm = 0.5;

double bias(const Motion&) {
  return kBias_Nm;
}

Dataset dataOf(double duration_s, std::uint64_t seed) {
  return {std::array{swinging(duration_s, kNoise_Nm, bias, seed)}, DatasetOptions{}};
}

/// A constant torque, and a drift that somebody claims to have found in it.
class Claimed {
 public:
  Claimed()
      : data_(dataOf(12.0, 1)),
        fitter_(data_, pendulum(), FitOptions{}),
        atoms_(recipeAtoms(fitter_, recipes(data_, pendulum().mechanism,
                                            std::vector<std::string>{"thermal_drift", "torque_bias"}, {},
                                            std::array{kSmoothing_rad_s}))),
        nominal_(fitter_.nominal()) {
    selection_.fit = with("thermal_drift");
    selection_.evidence.push_back({.p_value = 0.002, .gain = 100.0, .rivals = {}});
  }

  ModelFit with(const std::string& kind) {
    const auto atom = std::find_if(atoms_.items.begin(), atoms_.items.end(),
                                   [&](const Atom& item) { return item.recipe->kind == kind; });
    std::optional<ModelFit> start = withCandidate(fitter_, nominal_, *atom, Screened{});
    REQUIRE(start);
    return fitter_.fit(std::move(*start), *nominal_.weighting);
  }

  const Selection& judgedBy(const Dataset* heldout) {
    const double unit = redundancy(data_, selection_.fit, 1);
    for (bool may_exchange = true;
         findRivals(fitter_, atoms_,
                    {.unit = unit, .seed = 1, .heldout = heldout, .may_exchange = may_exchange}, selection_);
         may_exchange = false) {
    }
    return selection_;
  }

  /// The selection with each of its rivals instead.
  std::vector<Selection> exchanged() { return withRivals(fitter_, atoms_, selection_); }

  const ModelFitter& fitter() const { return fitter_; }
  const ModelFit& nominal() const { return nominal_; }

 private:
  Dataset data_;
  ModelFitter fitter_;
  Atoms atoms_;
  ModelFit nominal_;
  Selection selection_;
};

TEST_CASE("what explains the fitted part as well is a rival of what was found") {
  Claimed claimed;
  const Selection& judged = claimed.judgedBy(nullptr);
  REQUIRE(judged.fit.terms.size() == 1);
  CHECK(judged.fit.terms.front().recipe->kind == "thermal_drift");
  CHECK(judged.evidence.front().rivals == std::vector<std::string>{"torque_bias@1"});
}

TEST_CASE("an effect and its rival change places") {
  Claimed claimed;
  CHECK(claimed.exchanged().empty());
  claimed.judgedBy(nullptr);
  const std::vector<Selection> exchanged = claimed.exchanged();
  REQUIRE(exchanged.size() == 1);
  REQUIRE(exchanged[0].fit.terms.size() == 1);
  CHECK(exchanged[0].fit.terms[0].recipe->kind == "torque_bias");
  REQUIRE(exchanged[0].evidence.size() == 1);
  CHECK(exchanged[0].evidence[0].p_value == 0.002);
  CHECK(exchanged[0].evidence[0].rivals == std::vector<std::string>{"thermal_drift@1"});
}

TEST_CASE("a candidate without coefficients that was not screened begins where its atom is") {
  const Dataset data = dataOf(12.0, 1);
  ModelFitter fitter(data, pendulum(), FitOptions{});
  const Atoms atoms =
      recipeAtoms(fitter, recipes(data, pendulum().mechanism, std::vector<std::string>{"actuator_delay"}, {},
                                  std::array{kSmoothing_rad_s}));
  REQUIRE(!atoms.items.empty());
  const std::optional<ModelFit> start =
      withCandidate(fitter, fitter.nominal(), atoms.items.front(), Screened{});
  REQUIRE(start);
  CHECK(start->terms.back().nu == atoms.items.front().nu);
}

TEST_CASE("the rival that the held-out part speaks for takes the place of what was found") {
  Claimed claimed;
  const Dataset heldout = dataOf(60.0, 2);
  const Selection& judged = claimed.judgedBy(&heldout);
  REQUIRE(judged.fit.terms.size() == 1);
  CHECK(judged.fit.terms.front().recipe->kind == "torque_bias");
  // The torque that the drives give against it.
  CHECK(judged.fit.terms.front().c.front() == doctest::Approx(-kBias_Nm).epsilon(0.2));
  REQUIRE(judged.evidence.size() == 1);
  CHECK(judged.evidence.front().p_value == 0.002);
}

TEST_CASE("a fit predicts better by what it leaves less, and nothing is told without held-out data") {
  Claimed claimed;
  const ModelFit constant = claimed.with("torque_bias");
  const Dataset heldout = dataOf(60.0, 2);
  Prediction prediction(claimed.fitter(), claimed.nominal(), &heldout);
  CHECK(prediction.gain(claimed.nominal()) == 0.0);
  CHECK(prediction.gain(constant) > 10.0);
  Prediction none(claimed.fitter(), claimed.nominal(), nullptr);
  CHECK(none.gain(constant) == 0.0);
}

}  // namespace
}  // namespace patella::diagnose
