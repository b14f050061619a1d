#include "tools/diagnose/search/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Dense>

namespace patella::diagnose {
namespace {

bool looksAt(const ScreenedGroup& group) {
  return group.count > 0 && group.count <= kColumnsOfSecondLook;
}

/// Draws that are looked at together: enough for products of matrices.
constexpr int kDrawsAtATime = 32;

/// Looks at residuals, of the recording or drawn, all in the same way.
class Looker {
 public:
  Looker(const Dataset& data, const ModelFit& fit, const Atoms& atoms, const Eigen::MatrixXd& nuisance,
         const Screening& screening, const Screening::Statistic& statistic)
      : data_(data), fit_(fit), atoms_(atoms), screening_(screening), statistic_(statistic) {
    const FreeColumns free = freeColumns(fit, fit.prior_weight, nuisance);
    Eigen::MatrixXd free_Nm(fit.tangent.rows(), free.length.size());
    free_Nm << fit.tangent, nuisance;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(kSpanned);
    solver.compute(free.weighted);
    explained_Nm_ = free_Nm * free.length.cwiseInverse().asDiagonal() * solver.solve(screening.explained());
  }

  struct Choice {
    std::size_t atom = 0;
    double raw_gain = 0.0;
    Eigen::VectorXd c;  ///< products with the atom's basis
  };
  struct Look {
    Choice best;
    double unit = 1.0;  ///< mean square that the noise left brings a column of the atom
  };

  /// Residuals as Columns side by side. `priors`: rows of the priors, one column for each.
  std::vector<Look> at(const Eigen::MatrixXd& residuals, const Eigen::MatrixXd& priors) {
    const Eigen::MatrixXd& explained = screening_.explained();
    Eigen::MatrixXd rows(explained.rows(), residuals.cols());
    rows << fit_.weighting->apply(residuals), priors;
    const Eigen::MatrixXf products = screening_.products(rows);
    Eigen::MatrixXd left = residuals - explained_Nm_ * (explained.transpose() * rows);
    std::vector<Look> looks;
    for (Eigen::Index r = 0; r < residuals.cols(); ++r) {
      Choice best = mostSurprising(products.col(r));
      const Shape& shape = shapeOf(best.atom);
      left.col(r) -= shape.taken_Nm * best.c;
      const NoiseProcess noise(data_, left.col(r));
      double unit = 0.0;
      for (Eigen::Index k = 0; k < shape.dual.cols(); ++k) {
        unit += noise.variance(shape.dual.col(k)) + fit_.redundancy() * shape.prior.col(k).squaredNorm();
      }
      looks.push_back({.best = std::move(best), .unit = unit / static_cast<double>(shape.dual.cols())});
    }
    return looks;
  }

 private:
  /// Columns of an atom's basis, worked out once.
  struct Shape {
    Eigen::MatrixXd taken_Nm;  ///< what they take from a residual
    Eigen::MatrixXd dual;      ///< their products with a residual are those of the weighted ones
    Eigen::MatrixXd prior;     ///< their rows of the priors
  };

  Choice mostSurprising(const Eigen::VectorXf& products) const {
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
        best.atom = atom;
        best.raw_gain = gain;
      }
    }
    const ScreenedGroup& group = screening_.groups()[best.atom];
    best.c = products.segment(group.first, group.count).cast<double>();
    return best;
  }

  const Shape& shapeOf(std::size_t atom) {
    const auto known = shapes_.find(atom);
    if (known != shapes_.end()) {
      return known->second;
    }
    const Eigen::MatrixXd& explained = screening_.explained();
    const Eigen::MatrixXd columns = atoms_.of(atoms_.items[atom]) * screening_.combinations(atom);
    const Eigen::MatrixXd weighted = fit_.weighting->apply(columns);
    const Eigen::MatrixXd shares = explained.topRows(weighted.rows()).transpose() * weighted;
    const Eigen::MatrixXd basis = screening_.basis(atom);
    Shape shape{.taken_Nm = columns - explained_Nm_ * shares,
                .dual = fit_.weighting->transposed(basis.topRows(weighted.rows())),
                .prior = basis.bottomRows(basis.rows() - weighted.rows())};
    return shapes_.emplace(atom, std::move(shape)).first->second;
  }

  const Dataset& data_;
  const ModelFit& fit_;
  const Atoms& atoms_;
  const Screening& screening_;
  const Screening::Statistic& statistic_;
  Eigen::MatrixXd explained_Nm_;  ///< the Columns that Screening::explained() has weighted
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
  const Looker::Look seen = looker.at(fit.residual, fit.prior_residual).front();
  const ScreenedGroup& group = screening.groups()[seen.best.atom];
  SecondLook result{.screened = screening.results()[seen.best.atom], .p_value = 1.0};
  result.screened.gain = seen.best.raw_gain / withMotion(group, seen.unit);
  const double observed = statistic(result.screened.gain, group.dimensions);

  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const NoiseProcess process(data, fit.residual);
  std::vector<double> chance;
  for (int first = 0; first < replicates; first += kDrawsAtATime) {
    const Eigen::Index count = std::min(kDrawsAtATime, replicates - first);
    Eigen::MatrixXd residuals(fit.residual.size(), count);
    Eigen::MatrixXd priors(fit.prior_weight.size(), count);
    for (Eigen::Index r = 0; r < count; ++r) {
      residuals.col(r) = process.draw(random);
      priors.col(r) = Eigen::VectorXd::NullaryExpr(fit.prior_weight.size(),
                                                   [&] { return fit.prior_scale * normal(random); });
    }
    for (const Looker::Look& drawn : looker.at(residuals, priors)) {
      chance.push_back(
          statistic(drawn.best.raw_gain / drawn.unit, screening.groups()[drawn.best.atom].dimensions));
    }
  }
  result.p_value = exceedance(chance, observed);
  return result;
}

}  // namespace patella::diagnose
