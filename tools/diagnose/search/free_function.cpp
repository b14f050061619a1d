#include "tools/diagnose/search/free_function.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// A spring that hardens, softens or stops bends like a polynomial of this order.
constexpr int kSmoothOrder = 5;

// A ripple of few periods, or tissue with slopes far from the published ones, is a bend that took the nearest
// shape.
bool bends(const Dataset& data, const Term& term) {
  if (term.recipe->kind == "passive_knee_moment") {
    for (std::size_t k = 0; k < term.nu.size(); ++k) {
      if (!data.isStatic() &&
          std::abs(term.nu[k]) > asserted::kAnotherSlope * term.recipe->nonlinear[k].spread) {
        return true;
      }
    }
    return false;
  }
  const auto [low, high] = positionRange(data, term.recipe->joint);
  return term.recipe->kind == "torque_ripple" && term.nu[0] * (high - low) < asserted::kPlainCycles;
}

// Torque of these terms as the fit has it, as a Column.
Eigen::VectorXd torqueOf(const ModelFit& fit, const std::vector<std::size_t>& terms) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(fit.residual.size());
  for (const std::size_t t : terms) {
    const auto& c = fit.terms[t].c;
    for (std::size_t k = 0; k < c.size(); ++k) {
      sum += c[k] * fit.tangent.col(fit.offset[t] + static_cast<Eigen::Index>(k));
    }
  }
  return sum;
}

// Powers 0 … kSmoothOrder of the joint's position, its range brought to −1 … 1, as Columns.
Eigen::MatrixXd polynomial(const Dataset& data, int joint) {
  const auto [low, high] = positionRange(data, joint);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(data.rows() * data.joints(), kSmoothOrder + 1);
  for (int power = 0; power <= kSmoothOrder; ++power) {
    columns.col(power).segment(joint * data.rows(), data.rows()) =
        data.variable([&](const Series& series, std::size_t i) {
          const double x = (2.0 * series.states[i].q[joint] - low - high) / (high - low);
          return std::pow(x, power);
        });
  }
  return columns;
}

// Weighted squared error with `columns` in the place of these terms, all other parameters taking up what they
// can within what is known of them.
double errorWith(const ModelFit& fit, const std::vector<std::size_t>& terms, const Eigen::MatrixXd& columns) {
  std::vector<Eigen::Index> others;
  for (Eigen::Index k = 0; k < fit.tangent.cols(); ++k) {
    const bool replaced = std::any_of(terms.begin(), terms.end(), [&](std::size_t t) {
      const auto size = static_cast<Eigen::Index>(fit.terms[t].c.size() + fit.terms[t].nu.size());
      return k >= fit.offset[t] && k < fit.offset[t] + size;
    });
    if (!replaced) {
      others.push_back(k);
    }
  }
  const auto known = static_cast<Eigen::Index>(others.size());
  const Eigen::MatrixXd slope = fit.weighting->apply(fit.tangent(Eigen::all, others));
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(slope.rows() + known, known + columns.cols());
  all.topLeftCorner(slope.rows(), known) = slope;
  all.bottomLeftCorner(known, known) = fit.prior_weight(others).asDiagonal();
  all.topRightCorner(slope.rows(), columns.cols()) = fit.weighting->apply(columns);
  Eigen::VectorXd wanted(all.rows());
  wanted << fit.weighting->apply(fit.residual + torqueOf(fit, terms)), fit.prior_residual(others);
  // Columns are brought to one length, or the rank would depend on units.
  const Eigen::VectorXd length = all.colwise().norm().cwiseMax(1e-150);
  all = all * length.cwiseInverse().asDiagonal();
  return (wanted - all * all.completeOrthogonalDecomposition().solve(wanted)).squaredNorm();
}

// Whether a smooth spring would explain what these terms do about as well.
bool smoothDoes(const Dataset& data, const ModelFit& fit, const std::vector<std::size_t>& terms, int joint) {
  const double named = fit.weighting->apply(fit.residual).squaredNorm() + fit.prior_residual.squaredNorm();
  return errorWith(fit, terms, polynomial(data, joint)) - named < rivals::kAlike * fit.redundancy();
}

}  // namespace

std::vector<FreeFunction> freeFunctions(const Dataset& data, const Selection& selection) {
  std::vector<FreeFunction> found;
  for (int joint = 0; joint < data.joints(); ++joint) {
    std::vector<std::size_t> of_position;
    std::vector<std::size_t> reflexes;
    bool bent = false;
    for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
      const Term& term = selection.fit.terms[t];
      if (term.declared || term.recipe->joint != joint) {
        continue;
      }
      if (isOfPosition(term.recipe->kind)) {
        of_position.push_back(t);
        bent = bent || bends(data, term);
      } else if (term.recipe->kind == "spasticity") {
        reflexes.push_back(t);
      }
    }
    const auto add = [&](const std::vector<std::size_t>& terms, std::string_view stem) {
      double p_value = 0.0;
      for (const std::size_t t : terms) {
        p_value = std::max(p_value, selection.evidence[t].p_value);
      }
      found.push_back({.terms = terms,
                       .dependence = {.joint = joint,
                                      .variable = fmt::format("{}{}", stem, joint + 1),
                                      .explained_Nm = jointRms(data, torqueOf(selection.fit, terms), joint),
                                      .p_value = p_value}});
    };
    const bool tissue = std::any_of(of_position.begin(), of_position.end(), [&](std::size_t t) {
      return selection.fit.terms[t].recipe->kind == "passive_knee_moment";
    });
    if (bent && (tissue || of_position.size() > 1) && smoothDoes(data, selection.fit, of_position, joint)) {
      add(of_position, "q");
    }
    if (reflexes.size() > 1) {
      add(reflexes, "dq");
    }
  }
  return found;
}

}  // namespace patella::diagnose
