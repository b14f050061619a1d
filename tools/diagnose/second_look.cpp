#include "tools/diagnose/second_look.hpp"

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
    free_ << fit.tangent, nuisance;
    weighted_free_ = fit.weighting->apply(free_);
  }

  struct Look {
    std::size_t atom = 0;
    double raw_gain = 0.0;
    double unit = 1.0;  ///< mean square that the noise left brings a column of the atom
  };

  /// `prior`: rows of the priors, below the weighted rows of the residual.
  Look at(const Eigen::VectorXd& residual, const Eigen::VectorXd& prior) {
    Eigen::VectorXd rows(weighted_free_.rows() + prior.size());
    rows << fit_.weighting->apply(residual), prior;
    const Look best = mostSurprising(rows);
    Shape& shape = shapeOf(best.atom);
    const NoiseProcess left(data_, residual - shape.all * shape.solver.solve(rows));
    double unit = 0.0;
    for (Eigen::Index k = 0; k < shape.unweighted.cols(); ++k) {
      unit += left.variance(shape.unweighted.col(k)) +
              std::pow(fit_.prior_scale, 2) * shape.prior.col(k).squaredNorm();
    }
    return {.atom = best.atom,
            .raw_gain = best.raw_gain,
            .unit = unit / static_cast<double>(shape.unweighted.cols())};
  }

 private:
  /// What looking at one atom takes, worked out once.
  struct Shape {
    Eigen::MatrixXd all;  ///< whatever may take up something: free parameters, nuisance, the atom
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>
        solver;  ///< of the same, weighted, with the priors' rows
    Eigen::MatrixXd
        unweighted;  ///< the atom's basis, so that its product with a residual is that of the weighted ones
    Eigen::MatrixXd prior;  ///< the basis' rows of the priors
  };

  Look mostSurprising(const Eigen::VectorXd& rows) const {
    const Eigen::VectorXf products = screening_.products(rows);
    Look best;
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
        best = {.atom = atom, .raw_gain = gain, .unit = group.unit};
      }
    }
    return best;
  }

  Shape& shapeOf(std::size_t atom) {
    const auto known = shapes_.find(atom);
    if (known != shapes_.end()) {
      return known->second;
    }
    const Atom& item = atoms_.items[atom];
    const auto columns = atoms_.columns.middleCols(item.first, item.count);
    Shape shape;
    shape.all.resize(free_.rows(), free_.cols() + columns.cols());
    shape.all << free_, columns;
    const Eigen::Index priors = fit_.prior_weight.size();
    Eigen::MatrixXd weighted = Eigen::MatrixXd::Zero(weighted_free_.rows() + priors, shape.all.cols());
    weighted.topRows(weighted_free_.rows()) << weighted_free_, fit_.weighting->apply(columns);
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
  const ScreenedGroup& group = screening.groups()[seen.atom];
  SecondLook result{.screened = screening.results()[seen.atom], .p_value = 1.0};
  result.screened.gain = seen.raw_gain / withMotion(group, seen.unit);
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
    chance.push_back(statistic(drawn.raw_gain / drawn.unit, screening.groups()[drawn.atom].dimensions));
  }
  result.p_value = exceedance(chance, observed);
  return result;
}

}  // namespace patella::diagnose
