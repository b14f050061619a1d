#include "tools/diagnose/fit/edges.hpp"

#include <cmath>
#include <string>

#include <Eigen/Dense>

#include "tools/diagnose/effects/recipe_names.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

// Whether a coefficient at zero would gain more by a negative value than chance brings.
bool pulledBelow(const ModelFit& fit, Eigen::Index index) {
  const Eigen::MatrixXd slope = fit.weighting->apply(fit.tangent);
  const Eigen::VectorXd white = fit.weighting->apply(fit.residual);
  const Eigen::Index count = slope.cols();
  Eigen::MatrixXd tangent(slope.rows() + count, count);
  tangent << slope, Eigen::MatrixXd(fit.prior_weight.asDiagonal());
  Eigen::VectorXd target(white.size() + count);
  target << white, fit.prior_residual;
  const Eigen::VectorXd own = tangent.col(index);
  const Eigen::VectorXd length = tangent.colwise().norm().cwiseMax(1e-150);
  tangent *= length.cwiseInverse().asDiagonal();
  tangent.col(index).setZero();
  const Eigen::VectorXd rest = own - tangent * tangent.completeOrthogonalDecomposition().solve(own);
  const double pull = rest.dot(target);
  const double chance = fit.redundancy();
  return pull < 0.0 && pull * pull > accepted::kContradicted * chance * rest.squaredNorm();
}

}  // namespace

// A coefficient that rests at zero is no flaw as long as nothing pulls it below: friction may well be without
// the part that grows with speed. One that the data would have negative is another effect than its name says.
std::vector<Edge> edgesOf(const ModelFit& fit) {
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const Term& term = fit.terms[t];
    const Recipe& recipe = *term.recipe;
    for (std::size_t i = 0; i < term.c.size() && !term.declared; ++i) {
      const Eigen::Index index = fit.offset[t] + static_cast<Eigen::Index>(i);
      const double size = std::abs(term.c[i]) * fit.tangent.col(index).norm();
      if (recipe.nonnegative[i] && size < accepted::kNextToNothing * fit.residual.norm() &&
          pulledBelow(fit, index)) {
        edges.push_back({recipe.label(), "sign: " + coefficientName(recipe, term.nu, i)});
      } else if (std::abs(term.c[i]) >= recipe.largest) {
        edges.push_back({recipe.label(), "range: " + coefficientName(recipe, term.nu, i)});
      }
    }
    const std::string beyond = recipe.beyond && !term.declared ? recipe.beyond(term.c, term.nu) : "";
    if (!beyond.empty()) {
      edges.push_back({recipe.label(), "range: " + beyond});
    }
    for (std::size_t k = 0; k < term.nu.size() && !term.declared; ++k) {
      const NonlinearParameter& range = recipe.nonlinear[k];
      const double near = accepted::kNearBound * (range.upper - range.lower);
      if ((!range.open_above && term.nu[k] > range.upper - near) ||
          (range.closed_below && term.nu[k] < range.lower + 0.1 * near)) {
        edges.push_back({recipe.label(), "range: " + shapeName(recipe, term.c, term.nu, k)});
      }
    }
  }
  return edges;
}

}  // namespace patella::diagnose
