#include "tools/diagnose/search/candidate.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/effects/relations.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Not at the bound itself, from which a derivative by ν would vanish.
constexpr double kOffTheBound = 1e-3;

// Columns of the found effects in a fit that have a strength. Declared ones are held near their values and
// give no torque of any size; the mechanism is not among them.
Eigen::MatrixXd freeColumns(ModelFitter& fitter, const ModelFit& fit) {
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index count = 0;
  for (const Term& term : fit.terms) {
    if (!term.declared && !term.c.empty()) {
      parts.push_back(fitter.basis(*term.recipe, term.nu));
      count += parts.back().cols();
    }
  }
  Eigen::MatrixXd columns(fitter.data().rows() * fitter.data().joints(), count);
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& part : parts) {
    columns.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return columns;
}

// Which coefficients give something that `others` do not.
std::vector<bool> ownCoefficients(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& others) {
  std::vector<bool> own(static_cast<std::size_t>(basis.cols()), true);
  if (others.cols() == 0) {
    return own;
  }
  const Eigen::VectorXd length = others.colwise().norm().cwiseMax(1e-150);
  const auto decomposition =
      Eigen::MatrixXd(others * length.cwiseInverse().asDiagonal()).completeOrthogonalDecomposition();
  for (Eigen::Index k = 0; k < basis.cols(); ++k) {
    const Eigen::VectorXd rest =
        basis.col(k) - others * length.cwiseInverse().asDiagonal() * decomposition.solve(basis.col(k));
    own[static_cast<std::size_t>(k)] = rest.squaredNorm() > accepted::kRepeated * basis.col(k).squaredNorm();
  }
  return own;
}

// Coefficients that come nearest to what is left and to what the replaced terms gave.
std::vector<double> firstEstimate(const Recipe& recipe, const ModelFit& fit, const Eigen::MatrixXd& basis,
                                  const Eigen::VectorXd& given) {
  const Eigen::MatrixXd columns = fit.weighting->apply(basis);
  const Eigen::VectorXd target = fit.weighting->apply(fit.residual + given);
  const Eigen::VectorXd length = columns.colwise().norm().cwiseMax(1e-150);
  const Eigen::VectorXd c = Eigen::MatrixXd(columns * length.cwiseInverse().asDiagonal())
                                .completeOrthogonalDecomposition()
                                .solve(target)
                                .cwiseQuotient(length);
  std::vector<double> estimate(c.begin(), c.end());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i] = recipe.nonnegative[i] ? std::max(estimate[i], kOffTheBound) : estimate[i];
  }
  return estimate;
}

}  // namespace

std::shared_ptr<const Recipe> reduced(const std::shared_ptr<const Recipe>& recipe,
                                      const std::vector<bool>& kept) {
  if (std::find(kept.begin(), kept.end(), false) == kept.end()) {
    return recipe;
  }
  Recipe smaller = *recipe;
  smaller.nonnegative.clear();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i]) {
      smaller.nonnegative.push_back(recipe->nonnegative[i]);
    }
    smaller.variant += kept[i] ? " +" : " -";
  }
  smaller.parameters = [recipe, kept](std::span<const double> c, std::span<const double> nu) {
    std::vector<double> all(kept.size(), 0.0);
    std::size_t at = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      all[i] = kept[i] ? c[at++] : 0.0;
    }
    return recipe->parameters(all, nu);
  };
  smaller.basis = [recipe, kept](std::span<const double> nu) {
    const auto all = recipe->basis(nu);
    std::vector<std::vector<BasisTerm>> some;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (kept[i]) {
        some.push_back(all[i]);
      }
    }
    return some;
  };
  return std::make_shared<const Recipe>(std::move(smaller));
}

bool givenByOthers(ModelFitter& fitter, const ModelFit& fit, const Atom& atom) {
  if (atom.recipe->coefficients() == 0) {
    return false;
  }
  ModelFit beside = fit;
  std::erase_if(beside.terms, [&](const Term& term) { return contains(*atom.recipe, *term.recipe); });
  const std::vector<bool> own =
      ownCoefficients(fitter.basis(*atom.recipe, atom.nu), freeColumns(fitter, beside));
  return std::find(own.begin(), own.end(), true) == own.end();
}

std::optional<ModelFit> withCandidate(ModelFitter& fitter, const ModelFit& fit, const Atom& atom,
                                      const Screened& screened) {
  ModelFit start = fit;
  start.terms.clear();
  Term term{.recipe = atom.recipe, .c = {}, .nu = atom.nu, .declared = false, .prior_c = {}, .replaced = {}};
  Eigen::VectorXd given = Eigen::VectorXd::Zero(fit.residual.size());
  for (const Term& old : fit.terms) {
    if (!contains(*atom.recipe, *old.recipe)) {
      start.terms.push_back(old);
      continue;
    }
    given += fitter.torque(old);
    term.replaced.insert(term.replaced.end(), old.replaced.begin(), old.replaced.end());
    if (old.declared) {
      term.replaced.push_back(old);
    }
  }
  if (atom.recipe->coefficients() > 0) {
    const std::vector<bool> own =
        ownCoefficients(fitter.basis(*atom.recipe, atom.nu), freeColumns(fitter, start));
    if (std::find(own.begin(), own.end(), true) == own.end()) {
      return std::nullopt;
    }
    term.recipe = reduced(atom.recipe, own);
    term.c = firstEstimate(*term.recipe, fit, fitter.basis(*term.recipe, term.nu), given);
  } else if (atom.recipe->proportional && screened.c.size() > 0) {
    const NonlinearParameter& range = atom.recipe->nonlinear.front();
    term.nu[0] = std::clamp(term.nu[0] * screened.c[0], range.lower, range.upper);
  }
  start.terms.push_back(std::move(term));
  return start;
}

ModelFit withoutTerm(const ModelFit& fit, std::size_t term) {
  ModelFit smaller = fit;
  const auto place = smaller.terms.begin() + static_cast<std::ptrdiff_t>(term);
  const std::vector<Term> back = place->replaced;
  smaller.terms.erase(place);
  // Declared terms stand first, as they do in the model that was given.
  smaller.terms.insert(smaller.terms.begin(), back.begin(), back.end());
  return smaller;
}

}  // namespace patella::diagnose
