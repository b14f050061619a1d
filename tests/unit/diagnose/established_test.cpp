// Promises of the last look at what a search found: an effect whose strength may as well be nothing goes,
// beside others that stay.
#include "tools/diagnose/search/established.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/search/candidate.hpp"

namespace patella::diagnose {
namespace {

constexpr double kNoise_Nm = 0.05;
constexpr double kSmoothing_rad_s = 0.05;
constexpr int kReplicates = 99;

/// A recording and the effects that somebody claims to have found in it, whether they are there or not.
class Claimed {
 public:
  Claimed(const std::function<double(const Motion&)>& missing, const std::vector<std::string>& kinds)
      : data_(std::array{swinging(40.0, kNoise_Nm, missing)}, DatasetOptions{}),
        fitter_(data_, pendulum(), FitOptions{}) {
    const Atoms atoms =
        recipeAtoms(fitter_, recipes(data_, pendulum().mechanism, kinds, {}, std::array{kSmoothing_rad_s}));
    selection_.fit = fitter_.nominal();
    for (const std::string& kind : kinds) {
      const auto atom = std::find_if(atoms.items.begin(), atoms.items.end(),
                                     [&](const Atom& item) { return item.recipe->kind == kind; });
      std::optional<ModelFit> start = withCandidate(fitter_, selection_.fit, *atom, Screened{});
      REQUIRE(start);
      selection_.fit = fitter_.fit(std::move(*start), *selection_.fit.weighting);
      selection_.evidence.push_back({.p_value = 0.002, .gain = 100.0, .rivals = {}});
    }
  }

  std::vector<std::string> dropped() { return dropWhatIsNotEstablished(fitter_, selection_, kReplicates, 1); }

  std::vector<std::string> left() const {
    std::vector<std::string> kinds;
    for (const Term& term : selection_.fit.terms) {
      kinds.push_back(term.recipe->kind);
    }
    return kinds;
  }

  std::size_t evidence() const { return selection_.evidence.size(); }

 private:
  Dataset data_;
  ModelFitter fitter_;
  Selection selection_;
};

double viscous(const Motion& motion) {
  return 0.3 * motion.dq;
}

TEST_CASE("effects whose intervals keep clear of zero stay") {
  Claimed claimed([](const Motion& motion) { return viscous(motion) + 0.5; },
                  {"viscous_friction", "torque_bias"});
  CHECK(claimed.dropped().empty());
  CHECK(claimed.left() == std::vector<std::string>{"viscous_friction", "torque_bias"});
}

TEST_CASE("an effect of one number whose interval holds zero goes, and its evidence with it") {
  Claimed claimed(viscous, {"viscous_friction", "torque_bias"});
  CHECK(claimed.dropped() == std::vector<std::string>{"torque_bias@1"});
  CHECK(claimed.left() == std::vector<std::string>{"viscous_friction"});
  CHECK(claimed.evidence() == 1);
}

TEST_CASE("an effect of one number that is the only finding stays, even where its interval holds zero") {
  Claimed claimed([](const Motion&) { return 0.0; }, {"torque_bias"});
  CHECK(claimed.dropped().empty());
  CHECK(claimed.left() == std::vector<std::string>{"torque_bias"});
}

}  // namespace
}  // namespace patella::diagnose
