#include "tools/diagnose/search/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include <Eigen/Dense>

namespace patella::diagnose {
namespace {

/// Columns of which the others leave less than this share take up nothing of their own.
constexpr double kSpanned = 1e-7;

bool looksAt(const ScreenedGroup& group) {
  return group.count > 0 && group.count <= kColumnsOfSecondLook;
}

/// Looks at residuals, of the recording or drawn, all in the same way.
class Looker {
 public:
  Looker(const Dataset& data, const ModelFit& fit, const Atoms& atoms, const Eigen::MatrixXd& nuisance,
         const Screening& screening, const Screening::Statistic& statistic)
      : data_(data), fit_(fit), atoms_(atoms), screening_(screening), statistic_(statistic) {
    free_.resize(fit.tangent.rows(), fit.tangent.cols() + nuisance.cols());
    free_.leftCols(fit.tangent.cols()) = fit.tangent;
    free_.rightCols(nuisance.cols()) = nuisance;
    weighted_free_ = fit.weighting->apply(free_);
  }

  struct Choice {
    std::size_t atom = 0;
    double raw_gain = 0.0;
  };
  struct Look {
    Choice best;
    double unit = 1.0;  ///< mean square that the noise left brings a column of the atom
  };

  /// `prior`: rows of the priors, below the weighted rows of the residual.
  Look at(const Eigen::VectorXd& residual, const Eigen::VectorXd& prior) {
    Eigen::VectorXd rows(weighted_free_.rows() + prior.size());
    rows << fit_.weighting->apply(residual), prior;
    const Choice best = mostSurprising(rows);
    const Shape& shape = shapeOf(best.atom);
    const NoiseProcess left(data_, residual - shape.all * shape.solver.solve(rows));
    double unit = 0.0;
    for (Eigen::Index k = 0; k < shape.unweighted.cols(); ++k) {
      unit += left.variance(shape.unweighted.col(k)) +
              std::pow(fit_.prior_scale, 2) * shape.prior.col(k).squaredNorm();
    }
    return {.best = best, .unit = unit / static_cast<double>(shape.unweighted.cols())};
  }

 private:
  /// Data for looking at one atom, worked out once.
  struct Shape {
    /// Whatever may take up something: free parameters, nuisance, the atom.
    Eigen::MatrixXd all;
    /// Solves for the same, weighted, with the priors' rows below.
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    /// The atom's basis: columns whose products with a residual are those of the weighted ones.
    Eigen::MatrixXd unweighted;
    Eigen::MatrixXd prior;  ///< the basis' rows of the priors
  };

  Choice mostSurprising(const Eigen::VectorXd& rows) const {
    const Eigen::VectorXf products = screening_.products(rows);
    Choice best;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t atom = 0; atom < screening_.groups().size(); ++atom) {
      const ScreenedGroup& group = screening_.groups()[atom];
      if (!looksAt(group)) {
        continue;
      }
      const auto gain = static_cast<double>(products.segment(group.first, group.count).squaredNorm());
      const double value = statistic_(gain / group.unit, group.dimensions);
      if (value > most) {
        most = value;
        best = {.atom = atom, .raw_gain = gain};
      }
    }
    return best;
  }

  const Shape& shapeOf(std::size_t atom) {
    const auto known = shapes_.find(atom);
    if (known != shapes_.end()) {
      return known->second;
    }
    const Atom& item = atoms_.items[atom];
    const Eigen::MatrixXd columns = atoms_.of(item);
    Shape shape;
    shape.all.resize(free_.rows(), free_.cols() + columns.cols());
    shape.all.leftCols(free_.cols()) = free_;
    shape.all.rightCols(columns.cols()) = columns;
    const Eigen::Index priors = fit_.prior_weight.size();
    Eigen::MatrixXd weighted = Eigen::MatrixXd::Zero(weighted_free_.rows() + priors, shape.all.cols());
    weighted.topLeftCorner(weighted_free_.rows(), weighted_free_.cols()) = weighted_free_;
    weighted.topRightCorner(weighted_free_.rows(), columns.cols()) = fit_.weighting->apply(columns);
    weighted.bottomLeftCorner(priors, priors) = fit_.prior_weight.asDiagonal();
    // Columns are brought to one length, or the rank would depend on units.
    for (Eigen::Index k = 0; k < weighted.cols(); ++k) {
      const double length = weighted.col(k).norm();
      weighted.col(k) /= length > 0.0 ? length : 1.0;
      shape.all.col(k) /= length > 0.0 ? length : 1.0;
    }
    shape.solver.setThreshold(kSpanned);
    shape.solver.compute(weighted);
    const Eigen::MatrixXd basis = screening_.basis(atom);
    shape.unweighted = fit_.weighting->transposed(basis.topRows(weighted_free_.rows()));
    shape.prior = basis.bottomRows(priors);
    return shapes_.emplace(atom, std::move(shape)).first->second;
  }

  const Dataset& data_;
  const ModelFit& fit_;
  const Atoms& atoms_;
  const Screening& screening_;
  const Screening::Statistic& statistic_;
  Eigen::MatrixXd free_;
  Eigen::MatrixXd weighted_free_;
  std::map<std::size_t, Shape> shapes_;
};

}  // namespace

SecondLook lookAgain(const Dataset& data, const ModelFit& fit, const Atoms& atoms,
                     const Eigen::MatrixXd& nuisance, const Screening& screening,
                     const Screening::Statistic& statistic, int replicates, std::uint64_t seed) {
  if (std::none_of(screening.groups().begin(), screening.groups().end(), looksAt)) {
    return {};
  }
  Looker looker(data, fit, atoms, nuisance, screening, statistic);
  const Looker::Look seen = looker.at(fit.residual, fit.prior_residual);
  const ScreenedGroup& group = screening.groups()[seen.best.atom];
  SecondLook result{.screened = screening.results()[seen.best.atom], .p_value = 1.0};
  result.screened.gain = seen.best.raw_gain / withMotion(group, seen.unit);
  const double observed = statistic(result.screened.gain, group.dimensions);

  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const NoiseProcess process(data, fit.residual);
  std::vector<double> chance;
  for (int r = 0; r < replicates; ++r) {
    const Eigen::VectorXd residual = process.draw(random);
    const Eigen::VectorXd prior = Eigen::VectorXd::NullaryExpr(
        fit.prior_weight.size(), [&] { return fit.prior_scale * normal(random); });
    const Looker::Look drawn = looker.at(residual, prior);
    chance.push_back(
        statistic(drawn.best.raw_gain / drawn.unit, screening.groups()[drawn.best.atom].dimensions));
  }
  result.p_value = exceedance(chance, observed);
  return result;
}

}  // namespace patella::diagnose
