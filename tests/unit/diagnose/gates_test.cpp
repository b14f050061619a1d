// Whether a larger model holds on parts of a recording that it was not fitted to.
#include "tools/diagnose/search/gates.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/search/candidate.hpp"

namespace patella::diagnose {
namespace {

constexpr double kNoise_Nm = 0.05;

/// Fits of a pendulum without and with viscous friction.
struct Two {
  explicit Two(const std::function<double(const Motion&)>& missing)
      : data(std::array{swinging(40.0, kNoise_Nm, missing)}, DatasetOptions{}),
        fitter(data, pendulum(), FitOptions{}),
        smaller(fitter.nominal()) {
    const Atoms atoms =
        recipeAtoms(fitter, recipes(data, pendulum().mechanism, std::vector<std::string>{"viscous_friction"},
                                    {}, std::array{0.05}));
    std::optional<ModelFit> start = withCandidate(fitter, smaller, atoms.items.front(), Screened{});
    REQUIRE(start);
    larger = fitter.fit(std::move(*start), *smaller.weighting);
  }
  Blockwise blocks() const { return {smaller, larger}; }

  Dataset data;
  ModelFitter fitter;
  ModelFit smaller;
  ModelFit larger;
};

TEST_CASE("friction that is there all the time holds on every part") {
  const Two two([](const Motion& motion) { return 0.3 * motion.dq; });
  CHECK(two.blocks().foreseen());
  CHECK(two.blocks().isStable(10.0, 1));
}

TEST_CASE("no gain is more than any cost, nor foreseen where there is none") {
  const Two two([](const Motion&) { return 0.0; });
  CHECK_FALSE(two.blocks().isStable(1e9, 1));
  CHECK_FALSE(two.blocks().isStable(10.0, 1));
  CHECK_FALSE(two.blocks().foreseen());
}

TEST_CASE("a brake in one part of the recording is not foreseen from the others") {
  const Two two([](const Motion& motion) {
    return motion.time_s > 10.0 && motion.time_s < 14.0 ? 3.0 * motion.dq : 0.0;
  });
  CHECK_FALSE(two.blocks().foreseen());
}

TEST_CASE("blocks add up to the whole fit") {
  const Two two([](const Motion& motion) { return 0.3 * motion.dq; });
  const BlockEquations blocks(two.larger, *two.larger.weighting, 20);
  const BlockEquations::Sums whole = blocks.sums(std::vector<double>(20, 1.0));
  const Eigen::VectorXd best = blocks.solution(whole);
  const auto errorAt = [&](const Eigen::VectorXd& x) { return whole.error(x); };
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(best.size());
  CHECK(errorAt(zero) == doctest::Approx(two.larger.weighting->apply(two.larger.residual).squaredNorm()));
  CHECK(blocks.priorError(zero) == doctest::Approx(two.larger.prior_residual.squaredNorm()));
  // A fit is at its optimum already.
  CHECK(errorAt(best) + blocks.priorError(best) ==
        doctest::Approx(errorAt(zero) + blocks.priorError(zero)).epsilon(1e-4));
}

TEST_CASE("products by joint are those of whole columns, whichever joints feel them") {
  Eigen::MatrixXd columns = Eigen::MatrixXd::NullaryExpr(12, 4, [](Eigen::Index row, Eigen::Index column) {
    return std::sin(1.0 + 3.7 * static_cast<double>(row) + 1.3 * static_cast<double>(column));
  });
  columns.block(4, 0, 8, 1).setZero();
  columns.block(0, 2, 12, 1).setZero();
  columns.block(8, 3, 4, 1).setZero();
  CHECK((gramsByTime(columns, 4, 1).front() - columns.transpose() * columns).norm() < 1e-12);
}

}  // namespace
}  // namespace patella::diagnose
