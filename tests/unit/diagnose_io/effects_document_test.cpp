// Every effect of the library has its home, and docs/effects.md tells of it.
#include "tools/diagnose/output/effects_document.hpp"

#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/model/effect.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/recipe_parts.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

constexpr Motion kSwing{.joint = 0,
                        .velocity_rms = 1.0,
                        .lowest_position = -0.5,
                        .position_range = 1.0,
                        .torque_rms = 5.0,
                        .duration_s = 20.0,
                        .band_Hz = 14.0,
                        .inertia = 0.3,
                        .smoothing_rad_s = 0.01};

}  // namespace

TEST_CASE("every effect of the catalogue has one home, with recipes of its own kind") {
  std::set<std::string_view> known;
  for (const model::EffectDescriptor* effect : model::effectCatalogue()) {
    CAPTURE(effect->kind);
    known.insert(effect->kind);
    REQUIRE_NOTHROW(effectHome(effect->kind));
    const EffectHome& home = effectHome(effect->kind);
    CHECK(!home.what.empty());
    std::vector<Recipe> recipes;
    home.add(kSwing, std::array{1}, recipes);
    REQUIRE(!recipes.empty());
    for (const Recipe& recipe : recipes) {
      CHECK(recipe.kind == effect->kind);
      CHECK(recipe.joint == kSwing.joint);
      CHECK(recipe.parameters(std::vector<double>(recipe.coefficients(), 0.1), recipe.grid.front()).size() ==
            effect->parameters.size());
    }
  }
  CHECK(effectHomes().size() == known.size());
  for (const EffectHome& home : effectHomes()) {
    CAPTURE(home.kind);
    CHECK(known.contains(home.kind));
  }
}

TEST_CASE("strengths, and effects in whose place one stands, are of the catalogue") {
  for (const EffectHome& home : effectHomes()) {
    CAPTURE(home.kind);
    for (const auto& group : home.strengths) {
      for (const std::string_view name : group) {
        CAPTURE(name);
        CHECK_NOTHROW(Parameters(home.kind).of(name));
      }
    }
    std::vector<Recipe> recipes;
    home.add(kSwing, std::array{1}, recipes);
    for (const Recipe& recipe : recipes) {
      for (const std::string& simpler : recipe.contains) {
        CAPTURE(simpler);
        CHECK(model::findEffect(simpler) != nullptr);
      }
    }
  }
}

TEST_CASE("a kind without a home is refused by name") {
  CHECK_THROWS_WITH(effectHome("wind"), "effect wind has no home in tools/diagnose/effects");
}

TEST_CASE("docs/effects.md is what --list-effects prints") {
  const auto path = checkout::source() / "docs/effects.md";
  CHECK_MESSAGE(app::readFile(path) == effectsDocument(),
                "docs/effects.md is out of date: patella-diagnose --list-effects > docs/effects.md");
}
