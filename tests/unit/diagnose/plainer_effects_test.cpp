#include "tools/diagnose/verdict/plainer_effects.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <memory>
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

/// A recording in which a spring was found, though a bias would nearly do.
struct FoundSpring {
  Dataset data;
  model::DynamicsModel model = model::makeModel(pendulum());
  MissingEffects found;

  explicit FoundSpring(const std::function<double(const Motion&)>& missing)
      : data(std::array{swinging(40.0, kNoise_Nm, missing)}, DatasetOptions{}) {
    const std::vector<std::string> kinds{"linear_stiffness", "torque_bias"};
    found.fitter = std::make_unique<ModelFitter>(data, pendulum(), FitOptions{});
    found.nominal = found.fitter->nominal();
    found.atoms = recipeAtoms(*found.fitter,
                              recipes(data, pendulum().mechanism, kinds, {}, std::array{kSmoothing_rad_s}));
    for (const Atom& atom : found.atoms.items) {
      std::optional<ModelFit> start = atom.recipe->kind == "linear_stiffness"
                                          ? withCandidate(*found.fitter, found.nominal, atom, Screened{})
                                          : std::nullopt;
      if (start && found.selection.evidence.empty()) {
        found.selection.fit = found.fitter->fit(std::move(*start), *found.nominal.weighting);
        found.selection.evidence = {{.p_value = 0.002, .gain = 100.0, .rivals = {}}};
      }
    }
  }

  const Recipe& last() const { return *found.selection.fit.terms.back().recipe; }
};

/// Slow, and of no effect.
double wandering(const Motion& motion) {
  return 0.2 * std::sin(0.9 * motion.time_s) + 0.16 * std::sin(0.37 * motion.time_s + 1.0);
}

TEST_CASE("beside a rest that hides a spring, the bias that is known stands, and the spring may be it") {
  FoundSpring rig([](const Motion& motion) { return 4.0 + wandering(motion); });
  REQUIRE(rig.found.selection.fit.terms.size() == 1);
  preferPlainer(rig.model.mechanism(), std::array{kNoise_Nm}, {}, rig.found);
  REQUIRE(rig.found.selection.fit.terms.size() == 1);
  CHECK(rig.last().kind == "torque_bias");
  CHECK(rig.found.selection.evidence.back().rivals == std::vector<std::string>{"linear_stiffness@1"});
  CHECK(rig.found.selection.evidence.back().gain > 50.0);
}

TEST_CASE("a spring that is known stays, and so does one in whose place a bias would leave too much") {
  FoundSpring known([](const Motion& motion) { return 2.0 + 4.0 * motion.q; });
  preferPlainer(known.model.mechanism(), std::array{kNoise_Nm}, {}, known.found);
  CHECK(known.last().kind == "linear_stiffness");
  FoundSpring small([](const Motion& motion) { return 0.3 + 8.0 * wandering(motion); });
  preferPlainer(small.model.mechanism(), std::array{kNoise_Nm}, {}, small.found);
  CHECK(small.last().kind == "linear_stiffness");
}

}  // namespace
}  // namespace patella::diagnose
