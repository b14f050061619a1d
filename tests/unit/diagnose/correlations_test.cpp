// Correlations of what a fit estimated, under the names of the model's files.
#include "tools/diagnose/search/correlations.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tools/diagnose/effects/declared.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE(
    "correlations are those of the named parameters, and what a recording does not determine is left out") {
  ModelFit fit;
  fit.mechanism = {0.0};
  for (const model::EffectDescription& effect :
       {model::EffectDescription{.kind = "coulomb_friction", .joint = 0, .parameters = {2.0, 0.05}},
        model::EffectDescription{.kind = "torque_bias", .joint = 1, .parameters = {-0.5}}}) {
    fit.offset.push_back(static_cast<Eigen::Index>(1 + fit.terms.size()));
    fit.terms.push_back({.recipe = declaredRecipe(effect),
                         .c = {1.0},
                         .nu = {},
                         .declared = true,
                         .prior_c = {1.0},
                         .replaced = {}});
  }
  Eigen::MatrixXd covariance(3, 3);
  covariance << 0.04, 0.018, 0.0,  //
      0.018, 0.01, 0.004,          //
      0.0, 0.004, 0.04;
  const std::vector<std::string> names{"mass_kg"};
  const Correlations found = correlationsOf(fit, names, Eigen::MatrixXd::Identity(1, 1), covariance);
  CHECK(found.parameters ==
        std::vector<std::string>{"mass_kg", "coulomb_friction@1 level_Nm", "torque_bias@2 bias_Nm"});
  REQUIRE(found.matrix.size() == 3);
  CHECK(found.matrix[0][1] == doctest::Approx(0.9));
  CHECK(found.matrix[1][0] == found.matrix[0][1]);
  // The bias is the coefficient times a negative number.
  CHECK(found.matrix[1][2] == doctest::Approx(-0.2));
  CHECK(found.matrix[0][2] == 0.0);
  CHECK(found.matrix[2][2] == doctest::Approx(1.0));
}

TEST_CASE("a parameter without uncertainty correlates with nothing") {
  ModelFit fit;
  fit.mechanism = {0.0, 0.0};
  const std::vector<std::string> names{"mass_kg", "inertia_kg_m2"};
  const Correlations found =
      correlationsOf(fit, names, Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(0.0, 1.0).asDiagonal().toDenseMatrix());
  CHECK(std::isnan(found.matrix[0][1]));
  CHECK(found.matrix[1][1] == 1.0);
}
