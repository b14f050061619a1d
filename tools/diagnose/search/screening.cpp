#include "tools/diagnose/search/screening.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include <Eigen/Dense>

#include "tools/diagnose/regression/gram.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// A column of which the fit leaves less than this share adds nothing.
constexpr double kFullySpanned = 1e-10;
/// Share of the largest below which a column, beside the others of its atom, gets no coefficient.
constexpr double kNearlySpanned = 0.02;
/// Columns of a batch: enough for products of matrices, and all of them at once would take several times the
/// memory.
constexpr Eigen::Index kColumnsAtATime = 64;
/// Pieces of time over which products with the residual are summed.
constexpr std::size_t kClusters = 40;

// Combinations of columns that are orthonormal, from the products of the columns with each other; `before`
// are their squared lengths before the fit's share was taken out. The column of which most is left comes
// first.
Eigen::MatrixXd orthonormalCombinations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& before) {
  const Eigen::Index columns = gram.cols();
  const Eigen::VectorXd scale =
      (before.array() > 0.0).select(before.cwiseSqrt().cwiseInverse(), Eigen::VectorXd::Zero(columns));
  Eigen::MatrixXd left = scale.asDiagonal() * gram * scale.asDiagonal();
  Eigen::MatrixXd rests = scale.asDiagonal();  // of each column, beside those that were chosen
  Eigen::MatrixXd chosen(columns, columns);
  Eigen::Index count = 0;
  while (count < columns) {
    Eigen::Index pivot = 0;
    const double most = left.diagonal().maxCoeff(&pivot);
    if (!(most > kFullySpanned)) {
      break;
    }
    const Eigen::VectorXd rest = rests.col(pivot);
    const Eigen::VectorXd products = left.col(pivot);
    chosen.col(count++) = rest / std::sqrt(most);
    rests -= rest * products.transpose() / most;
    left -= products * products.transpose() / most;
    left(pivot, pivot) = 0.0;
  }
  return chosen.leftCols(count);
}

// Least-squares coefficients from the columns' products with each other and with the residual; of columns
// that the fit nearly spans none that are large against the others.
Eigen::VectorXd coefficients(const Eigen::MatrixXd& gram, const Eigen::VectorXd& moment,
                             const Eigen::VectorXd& before) {
  const Eigen::VectorXd length = before.cwiseSqrt().cwiseMax(1e-12);
  const Eigen::MatrixXd scaled =
      length.cwiseInverse().asDiagonal() * gram * length.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const Eigen::VectorXd root = eigen.eigenvalues().cwiseMax(kFullySpanned).cwiseSqrt();
  // Columns with the same products in as many rows as there are columns.
  const Eigen::MatrixXd columns = root.asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::VectorXd right =
      (eigen.eigenvectors().transpose() * moment.cwiseQuotient(length)).cwiseQuotient(root);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(kNearlySpanned);
  decomposition.compute(columns);
  return decomposition.solve(right).cwiseQuotient(length);
}

}  // namespace

/// Products of an atom's weighted columns w without the fit's share, w − E Eᵀ w, whole and piece by piece of
/// time.
struct Screening::Products {
  Eigen::VectorXd before;                  ///< diagonal of wᵀw
  Eigen::MatrixXd gram;                    ///< with each other
  Eigen::VectorXd moment;                  ///< with the residual
  std::vector<Eigen::MatrixXd> gram_of;    ///< of the weighted rows of each piece
  std::vector<Eigen::VectorXd> moment_of;  ///< the same with the residual

  // Mean square that chance brings a column of the basis, from sums of its products with the residual over
  // pieces of time (Liang and Zeger, Biometrika 73, 1986).
  double clusteredVariance(const Eigen::MatrixXd& basis) const {
    const Eigen::Index units = basis.cols();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(units, units);
    Eigen::VectorXd taken = Eigen::VectorXd::Zero(units);
    for (std::size_t piece = 0; piece < gram_of.size(); ++piece) {
      all += basis.transpose() * gram_of[piece] * basis;
      taken += basis.transpose() * moment_of[piece];
    }
    // What the basis takes up of the residual's weighted rows, one column after the other.
    for (Eigen::Index unit = 1; unit < units; ++unit) {
      taken[unit] -= all.row(unit).head(unit).dot(taken.head(unit));
    }
    double sum = 0.0;
    for (std::size_t piece = 0; piece < gram_of.size(); ++piece) {
      sum += (basis.transpose() * (moment_of[piece] - gram_of[piece] * (basis * taken))).squaredNorm();
    }
    // The part of the residual that the basis took up is missing in the sums.
    const auto pieces = static_cast<double>(gram_of.size());
    return sum / static_cast<double>(units) * pieces / (pieces - static_cast<double>(units));
  }
};

double withMotion(const ScreenedGroup& group, double unit) {
  return std::clamp(group.seen_in_time, unit, accepted::kMostByMotion * unit);
}

Screening::Screening(const Dataset& data, const ModelFit& fit, const Atoms& atoms,
                     const ScreeningOptions& options)
    : atoms_(atoms),
      joints_(data.joints()),
      weighting_(fit.weighting),
      explained_(takenUp(fit, fit.prior_weight, options.nuisance)),
      batches_(batches()),
      orthonormal_(atoms.items.size()),
      groups_(atoms.items.size()),
      results_(atoms.items.size()) {
  const Left left = leftOf(fit, options.goes_with_motion ? kClusters : 1);
  for (Batch& batch : batches_) {
    const Weighed weighed = weigh(batch, left);
    for (std::size_t a = 0; a < batch.atoms.size(); ++a) {
      screen(batch.atoms[a], productsOf(batch, a, weighed, left), options.goes_with_motion);
    }
  }
  Eigen::Index used = 0;
  for (ScreenedGroup& group : groups_) {
    group.first = used;
    used += group.count;
  }
  drawChance(data, fit, options);
}

std::pair<Eigen::Index, Eigen::Index> Screening::Left::rowsOf(std::size_t piece) const noexcept {
  const auto count = static_cast<Eigen::Index>(gram.size());
  const auto number = static_cast<Eigen::Index>(piece);
  const Eigen::Index begin = rows * number / count;
  return {begin, rows * (number + 1) / count - begin};
}

Screening::Left Screening::leftOf(const ModelFit& fit, std::size_t pieces) const {
  const Eigen::VectorXd white = weighting_->apply(fit.residual);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(explained_.rows());
  residual.head(white.size()) = white;
  residual.tail(fit.prior_residual.size()) = fit.prior_residual;
  residual -= explained_ * (explained_.transpose() * residual);

  Left left;
  left.rows = weighting_->rows();
  left.precision = weighting_->precision();
  const auto basis = explained_.topRows(white.size());
  left.basis = weighting_->gathered(basis);
  left.residual = weighting_->gathered(residual.head(white.size()));
  left.gram.assign(pieces, Eigen::MatrixXd::Zero(basis.cols(), basis.cols()));
  left.moment.assign(pieces, Eigen::VectorXd::Zero(basis.cols()));
  // Nobody asks for the pieces of the whole.
  for (std::size_t piece = 0; pieces > 1 && piece < pieces; ++piece) {
    const auto [begin, size] = left.rowsOf(piece);
    for (Eigen::Index first = begin; first < white.size(); first += left.rows) {
      left.gram[piece] += gramOf(basis.middleRows(first, size));
      left.moment[piece] += basis.middleRows(first, size).transpose() * residual.segment(first, size);
    }
  }
  return left;
}

std::vector<Screening::Batch> Screening::batches() const {
  const Eigen::Index rows = weighting_->rows();
  std::map<std::optional<int>, std::vector<std::size_t>> by_joint;
  for (std::size_t atom = 0; atom < atoms_.items.size(); ++atom) {
    by_joint[atoms_.onlyJoint(atoms_.items[atom])].push_back(atom);
  }
  std::vector<Batch> all;
  for (const auto& [joint, atoms] : by_joint) {
    Eigen::Index columns = kColumnsAtATime;
    for (const std::size_t atom : atoms) {
      if (columns >= kColumnsAtATime) {
        columns = 0;
        all.emplace_back();
        all.back().span =
            joint ? Span{.first = *joint * rows, .joints = 1} : Span{.first = 0, .joints = joints_};
      }
      all.back().atoms.push_back(atom);
      all.back().first.push_back(columns);
      columns += atoms_.items[atom].count;
    }
  }
  return all;
}

// Fills the batch's columns and their products with the basis of what the fit explains.
Screening::Weighed Screening::weigh(Batch& batch, const Left& left) const {
  const Eigen::Index count = batch.first.back() + atoms_.items[batch.atoms.back()].count;
  const Eigen::Index joints = batch.span.joints;
  Weighed weighed{.own = Eigen::MatrixXd(joints * left.rows, count),
                  .dual = Eigen::MatrixXd::Zero(joints * left.rows, count),
                  .explained = {},
                  .taken = {}};
  for (std::size_t a = 0; a < batch.atoms.size(); ++a) {
    const Atom& atom = atoms_.items[batch.atoms[a]];
    weighed.own.middleCols(batch.first[a], atom.count) =
        weighting_->filtered(atoms_.of(atom)).middleRows(batch.span.first, weighed.own.rows());
  }
  batch.columns = weighed.own.cast<float>();
  const Eigen::Index first_joint = batch.span.first / left.rows;
  for (Eigen::Index to = 0; to < joints; ++to) {
    for (Eigen::Index from = 0; from < joints; ++from) {
      weighed.dual.middleRows(to * left.rows, left.rows) +=
          left.precision(first_joint + to, first_joint + from) *
          weighed.own.middleRows(from * left.rows, left.rows);
    }
  }
  batch.explained = Eigen::MatrixXd::Zero(left.basis.cols(), count);
  for (std::size_t piece = 0; piece < left.gram.size(); ++piece) {
    const auto [begin, size] = left.rowsOf(piece);
    Eigen::MatrixXd explained = Eigen::MatrixXd::Zero(left.basis.cols(), count);
    for (Eigen::Index first = begin; first < weighed.own.rows(); first += left.rows) {
      explained += left.basis.middleRows(batch.span.first + first, size).transpose() *
                   weighed.own.middleRows(first, size);
    }
    batch.explained += explained;
    weighed.explained.push_back(std::move(explained));
  }
  for (const Eigen::MatrixXd& gram : left.gram) {
    weighed.taken.push_back(gram * batch.explained);
  }
  return weighed;
}

Screening::Products Screening::productsOf(const Batch& batch, std::size_t a, const Weighed& weighed,
                                          const Left& left) const {
  const Eigen::Index at = batch.first[a];
  const Eigen::Index width = atoms_.items[batch.atoms[a]].count;
  const auto explained = batch.explained.middleCols(at, width);
  Products products{.before = {},
                    .gram = Eigen::MatrixXd::Zero(width, width),
                    .moment = Eigen::VectorXd::Zero(width),
                    .gram_of = {},
                    .moment_of = {}};
  for (std::size_t piece = 0; piece < left.gram.size(); ++piece) {
    const auto [begin, size] = left.rowsOf(piece);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(width, width);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(width);
    for (Eigen::Index first = begin; first < weighed.own.rows(); first += left.rows) {
      const auto part = weighed.own.block(first, at, size, width);
      gram += part.transpose() * weighed.dual.block(first, at, size, width);
      moment += part.transpose() * left.residual.segment(batch.span.first + first, size);
    }
    products.gram += gram;
    products.moment += moment;
    const Eigen::MatrixXd shared = weighed.explained[piece].middleCols(at, width).transpose() * explained;
    gram += explained.transpose() * weighed.taken[piece].middleCols(at, width) - shared - shared.transpose();
    moment -= explained.transpose() * left.moment[piece];
    products.gram_of.push_back(std::move(gram));
    products.moment_of.push_back(std::move(moment));
  }
  products.before = products.gram.diagonal();
  products.gram -= explained.transpose() * explained;
  return products;
}

void Screening::screen(std::size_t index, const Products& products, bool in_time) {
  const Atom& atom = atoms_.items[index];
  const bool one_sided = atom.count == 1 && atom.recipe != nullptr &&
                         (atom.recipe->coefficients() == 0 || atom.recipe->nonnegative[0]);
  const Eigen::MatrixXd basis = orthonormalCombinations(products.gram, products.before);
  Screened& result = results_[index];
  result.atom = index;
  result.c = Eigen::VectorXd::Zero(atom.count);
  ScreenedGroup& group = groups_[index];
  group.count = basis.cols();
  group.one_sided = one_sided;
  if (basis.cols() > 0) {
    result.dimensions = static_cast<int>(basis.cols()) + atom.nonlinear;
    result.c = coefficients(products.gram, products.moment, products.before);
    // A single column keeps its sign, for one-sided tests.
    result.raw_gain = (basis.transpose() * products.moment).squaredNorm();
    group.seen_in_time = in_time ? products.clusteredVariance(basis) : 0.0;
  }
  group.dimensions = result.dimensions;
  result.wrong_sign = one_sided && result.c[0] < 0.0;
  orthonormal_[index] = basis;
}

void Screening::drawChance(const Dataset& data, const ModelFit& fit, const ScreeningOptions& options) {
  std::mt19937_64 random(options.seed);
  products_ = products(weightedDraws(data, fit, options.replicates, random));
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    ScreenedGroup& group = groups_[g];
    if (group.count > 0) {
      group.unit = products_.middleRows(group.first, group.count).squaredNorm() /
                   static_cast<double>(group.count * products_.cols());
      const double raw = results_[g].raw_gain;
      results_[g].gain = raw > 0.0 ? raw / withMotion(group, group.unit) : 0.0;
    }
  }
}

Eigen::MatrixXd Screening::basis(std::size_t atom) const {
  const Eigen::MatrixXd columns = weighting_->apply(atoms_.of(atoms_.items[atom]));
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(explained_.rows(), columns.cols());
  rows.topRows(columns.rows()) = columns;
  rows -= explained_ * (explained_.transpose() * rows);
  return rows * orthonormal_[atom];
}

Eigen::MatrixXf Screening::products(const Eigen::MatrixXd& rows) const {
  Eigen::Index count = 0;
  for (const ScreenedGroup& group : groups_) {
    count += group.count;
  }
  Eigen::MatrixXf all(count, rows.cols());
  const Eigen::MatrixXd explained = explained_.transpose() * rows;
  const Eigen::MatrixXf gathered =
      weighting_->gathered(rows.topRows(weighting_->rows() * joints_)).cast<float>();
  for (const Batch& batch : batches_) {
    const Eigen::MatrixXd left =
        (batch.columns.transpose() * gathered.middleRows(batch.span.first, batch.columns.rows()))
            .cast<double>() -
        batch.explained.transpose() * explained;
    for (std::size_t a = 0; a < batch.atoms.size(); ++a) {
      const std::size_t atom = batch.atoms[a];
      all.middleRows(groups_[atom].first, groups_[atom].count) =
          (orthonormal_[atom].transpose() * left.middleRows(batch.first[a], orthonormal_[atom].rows()))
              .cast<float>();
    }
  }
  return all;
}

std::vector<double> Screening::chance(const Statistic& statistic) const {
  std::vector<double> largest(static_cast<std::size_t>(products_.cols()),
                              -std::numeric_limits<double>::infinity());
  for (Eigen::Index r = 0; r < products_.cols(); ++r) {
    for (const ScreenedGroup& group : groups_) {
      if (group.count == 0 || (group.one_sided && products_(group.first, r) < 0.0F)) {
        continue;
      }
      const double square = products_.col(r).segment(group.first, group.count).squaredNorm();
      // Where a fit leaves nothing at all, chance brings nothing, and its unit is none.
      const double gain = square > 0.0 ? square / group.unit : 0.0;
      double& best = largest[static_cast<std::size_t>(r)];
      best = std::max(best, statistic(gain, group.dimensions));
    }
  }
  return largest;
}

}  // namespace patella::diagnose
