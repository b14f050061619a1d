#include "tools/diagnose/search/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <Eigen/Dense>

#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// A column of which the fit leaves less than this share adds nothing.
constexpr double kSpannedExactly = 1e-10;

// Sine and cosine at the times of the rows: thousands of frequencies are tried, and filtering each would take
// most of the time of a diagnosis.
Eigen::MatrixXd oscillationColumns(const Dataset& data, int joint, double frequency_Hz) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(data.rows() * data.joints(), 2);
  const Eigen::ArrayXd angle = 2.0 * std::numbers::pi * frequency_Hz * data.time_s().array();
  const double gain = data.gain(frequency_Hz);
  columns.col(0).segment(joint * data.rows(), data.rows()) = -gain * angle.sin();
  columns.col(1).segment(joint * data.rows(), data.rows()) = -gain * angle.cos();
  return columns;
}

bool isOscillation(const Atom& atom) {
  return atom.recipe != nullptr && atom.recipe->kind == "tremor";
}

// The part of the columns that is not spanned already; `before` are their squared lengths before the fit's
// share was taken out.
std::vector<Eigen::VectorXd> orthonormalised(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                                             const Eigen::VectorXd& before) {
  std::vector<Eigen::VectorXd> kept;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    Eigen::VectorXd rest = columns.col(k);
    for (const Eigen::VectorXd& unit : kept) {
      rest -= unit * unit.dot(rest);
    }
    if (rest.squaredNorm() > kSpannedExactly * before[k] && rest.squaredNorm() > 0.0) {
      kept.push_back(rest.normalized());
    }
  }
  return kept;
}

// Least-squares coefficients; of columns that the fit nearly spans none that are large against the others.
Eigen::VectorXd coefficients(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Eigen::VectorXd& before,
                             const Eigen::VectorXd& residual) {
  const Eigen::VectorXd length = before.cwiseSqrt().cwiseMax(1e-12);
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(0.02);
  decomposition.compute(columns * length.cwiseInverse().asDiagonal());
  return decomposition.solve(residual).cwiseQuotient(length);
}

// Residuals drawn from a fit's noise, weighted; below them the priors' rows.
Eigen::MatrixXd weightedDraws(const Dataset& data, const ModelFit& fit, int count, std::mt19937_64& random) {
  const NoiseProcess process(data, fit.residual);
  const Eigen::Index rows = fit.weighting->rows() * data.joints();
  Eigen::MatrixXd draws(rows + fit.prior_weight.size(), count);
  for (int r = 0; r < count; ++r) {
    draws.col(r).head(rows) = fit.weighting->apply(process.draw(random));
  }
  std::normal_distribution<double> normal;
  for (Eigen::Index r = 0; r < count; ++r) {
    for (Eigen::Index i = rows; i < draws.rows(); ++i) {
      draws(i, r) = fit.prior_scale * normal(random);
    }
  }
  return draws;
}

constexpr Eigen::Index kColumnsAtATime = 64;
constexpr Eigen::Index kClusters = 40;

// Mean square that chance brings a column of the basis, from sums of its products with the residual over
// pieces of time (Liang and Zeger, Biometrika 73, 1986).
double clusteredVariance(const std::vector<Eigen::VectorXd>& basis, Eigen::VectorXd residual, int joints) {
  for (const Eigen::VectorXd& unit : basis) {
    const auto column = unit.head(residual.size());
    residual -= column * column.dot(residual);
  }
  const Eigen::Index rows = residual.size() / joints;
  double sum = 0.0;
  for (Eigen::Index cluster = 0; cluster < kClusters; ++cluster) {
    const Eigen::Index begin = rows * cluster / kClusters;
    const Eigen::Index size = rows * (cluster + 1) / kClusters - begin;
    for (const Eigen::VectorXd& unit : basis) {
      double product = 0.0;
      for (int joint = 0; joint < joints; ++joint) {
        const Eigen::Index first = joint * rows + begin;
        product += unit.segment(first, size).dot(residual.segment(first, size));
      }
      sum += product * product;
    }
  }
  // The part of the residual that the basis took up is missing in the sums.
  const auto taken = static_cast<double>(basis.size());
  return sum / taken * static_cast<double>(kClusters) / (static_cast<double>(kClusters) - taken);
}

}  // namespace

Eigen::MatrixXd takenUp(const ModelFit& fit, const Eigen::VectorXd& prior_weight,
                        const Eigen::MatrixXd& nuisance) {
  const Eigen::MatrixXd slope = fit.weighting->apply(fit.tangent);
  Eigen::MatrixXd tangent =
      Eigen::MatrixXd::Zero(slope.rows() + slope.cols(), slope.cols() + nuisance.cols());
  tangent.topLeftCorner(slope.rows(), slope.cols()) = slope;
  tangent.bottomLeftCorner(slope.cols(), slope.cols()) = prior_weight.asDiagonal();
  if (nuisance.cols() > 0) {
    tangent.topRightCorner(slope.rows(), nuisance.cols()) = fit.weighting->apply(nuisance);
  }
  // Columns are brought to one length, or the rank would depend on units.
  for (Eigen::Index k = 0; k < tangent.cols(); ++k) {
    const double length = tangent.col(k).norm();
    tangent.col(k) /= length > 0.0 ? length : 1.0;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(tangent);
  qr.setThreshold(1e-7);
  return qr.householderQ() * Eigen::MatrixXd::Identity(tangent.rows(), qr.rank());
}

double withMotion(const ScreenedGroup& group, double unit) {
  return std::clamp(group.seen_in_time, unit, accepted::kMostByMotion * unit);
}

Eigen::MatrixXd Atoms::of(const Atom& atom) const {
  return isOscillation(atom) ? oscillationColumns(*data, atom.joint, atom.nu.front())
                             : Eigen::MatrixXd(columns.middleCols(atom.first, atom.count));
}

Atoms recipeAtoms(ModelFitter& fitter, std::span<const std::shared_ptr<const Recipe>> recipes) {
  Atoms atoms{.items = {}, .columns = {}, .data = &fitter.data()};
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index total = 0;
  for (const auto& recipe : recipes) {
    for (const std::vector<double>& nu : recipe->grid) {
      Atom atom{.recipe = recipe,
                .nu = nu,
                .label = recipe->label(),
                .joint = recipe->joint,
                .first = total,
                .count = static_cast<Eigen::Index>(recipe->coefficients()),
                .nonlinear = static_cast<int>(nu.size()) - (recipe->coefficients() == 0 ? 1 : 0)};
      if (!isOscillation(atom)) {
        parts.push_back(fitter.basis(*recipe, nu));
        atom.count = parts.back().cols();
        total += atom.count;
      }
      atoms.items.push_back(std::move(atom));
    }
  }
  atoms.columns.resize(fitter.data().rows() * fitter.data().joints(), total);
  Eigen::Index first = 0;
  for (Eigen::MatrixXd& part : parts) {
    atoms.columns.middleCols(first, part.cols()) = part;
    first += part.cols();
    part.resize(0, 0);
  }
  return atoms;
}

Screening::Screening(const Dataset& data, const ModelFit& fit, const Atoms& atoms,
                     const ScreeningOptions& options)
    : explained_(takenUp(fit, fit.prior_weight, options.nuisance)) {
  const Eigen::VectorXd white = fit.weighting->apply(fit.residual);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(explained_.rows());
  residual.head(white.size()) = white;
  residual.tail(fit.prior_residual.size()) = fit.prior_residual;
  residual -= explained_ * (explained_.transpose() * residual);

  Eigen::Index total = 0;
  for (const Atom& atom : atoms.items) {
    total += atom.count;
  }
  basis_.resize(explained_.rows(), total);
  Eigen::Index used = 0;
  for (std::size_t first = 0; first < atoms.items.size();) {
    // So many at a time: weighting and projection are products of matrices, and all of them at once would
    // take several times the memory of the basis.
    std::size_t end = first;
    Eigen::Index count = 0;
    while (end < atoms.items.size() && count < kColumnsAtATime) {
      count += atoms.items[end++].count;
    }
    Eigen::MatrixXd raw(data.rows() * data.joints(), count);
    Eigen::Index column = 0;
    for (std::size_t a = first; a < end; ++a) {
      raw.middleCols(column, atoms.items[a].count) = atoms.of(atoms.items[a]);
      column += atoms.items[a].count;
    }
    Eigen::MatrixXd work = Eigen::MatrixXd::Zero(explained_.rows(), count);
    work.topRows(white.size()) = fit.weighting->apply(raw);
    const Eigen::VectorXd before = work.colwise().squaredNorm();
    work -= explained_ * (explained_.transpose() * work);
    column = 0;
    for (; first < end; ++first) {
      const Eigen::Index width = atoms.items[first].count;
      screen(atoms.items[first], first, work.middleCols(column, width), before.segment(column, width),
             {.residual = residual, .white_rows = white.size(), .joints = data.joints()}, options, used);
      column += width;
    }
  }
  basis_.conservativeResize(Eigen::NoChange, used);
  drawChance(data, fit, options);
}

void Screening::screen(const Atom& atom, std::size_t index, const Eigen::Ref<const Eigen::MatrixXd>& group,
                       const Eigen::VectorXd& before, const Left& left, const ScreeningOptions& options,
                       Eigen::Index& used) {
  const std::vector<Eigen::VectorXd> kept = orthonormalised(group, before);
  const bool one_sided = atom.count == 1 && atom.recipe != nullptr &&
                         (atom.recipe->coefficients() == 0 || atom.recipe->nonnegative[0]);
  Screened result{.atom = index,
                  .raw_gain = 0.0,
                  .gain = 0.0,
                  .wrong_sign = false,
                  .dimensions = 0,
                  .c = Eigen::VectorXd::Zero(atom.count)};
  if (!kept.empty()) {
    result.dimensions = static_cast<int>(kept.size()) + atom.nonlinear;
    result.c = coefficients(group, before, left.residual);
  }
  groups_.push_back({.first = used,
                     .count = static_cast<Eigen::Index>(kept.size()),
                     .dimensions = result.dimensions,
                     .one_sided = one_sided});
  if (options.goes_with_motion && !kept.empty()) {
    groups_.back().seen_in_time = clusteredVariance(kept, left.residual.head(left.white_rows), left.joints);
  }
  for (const Eigen::VectorXd& unit : kept) {
    result.raw_gain += std::pow(unit.dot(left.residual), 2);
    basis_.col(used++) = unit.cast<float>();  // a single column keeps its sign, for one-sided tests
  }
  result.wrong_sign = one_sided && result.c[0] < 0.0;
  results_.push_back(std::move(result));
}

void Screening::drawChance(const Dataset& data, const ModelFit& fit, const ScreeningOptions& options) {
  std::mt19937_64 random(options.seed);
  Eigen::MatrixXd draws = weightedDraws(data, fit, options.replicates, random);
  draws -= explained_ * (explained_.transpose() * draws);
  products_ = basis_.transpose() * draws.cast<float>();
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
  const ScreenedGroup& group = groups_[atom];
  return basis_.middleCols(group.first, group.count).cast<double>();
}

Eigen::VectorXf Screening::products(const Eigen::VectorXd& rows) const {
  return basis_.transpose() * rows.cast<float>();  // the basis has nothing of what the fit explains
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

namespace {

constexpr int kUnitDraws = 199;

}  // namespace

double redundancy(const Dataset& data, const ModelFit& fit, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ModelFit free = fit;
  free.prior_weight.setZero();
  const Eigen::MatrixXd explained = takenUp(free, free.prior_weight);
  const Eigen::MatrixXd draws = weightedDraws(data, free, kUnitDraws, random);
  if (explained.cols() == 0) {
    return 1.0;  // at rest and without gravity no parameter takes up anything
  }
  const Eigen::Index rows = draws.rows() - free.prior_weight.size();
  const double share = (explained.topRows(rows).transpose() * draws.topRows(rows)).squaredNorm() /
                       static_cast<double>(explained.cols() * kUnitDraws);
  return std::clamp(share, 1.0, accepted::kLargestRedundancy);
}

double chanceUnit(const Dataset& data, const ModelFit& fit, Eigen::Index count, std::uint64_t seed) {
  const Eigen::Index parameters = fit.tangent.cols();
  ModelFit others = fit;
  others.tangent = fit.tangent.leftCols(parameters - count);
  others.prior_weight = fit.prior_weight.head(parameters - count);
  const Eigen::MatrixXd explained = takenUp(others, others.prior_weight);
  std::mt19937_64 random(seed);
  Eigen::MatrixXd draws = weightedDraws(data, others, kUnitDraws, random);
  const Eigen::MatrixXd added = fit.weighting->apply(fit.tangent.rightCols(count));
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(explained.rows(), count);
  columns.topRows(added.rows()) = added;
  const Eigen::VectorXd before = columns.colwise().squaredNorm();
  columns -= explained * (explained.transpose() * columns);
  double sum = 0.0;
  const std::vector<Eigen::VectorXd> kept = orthonormalised(columns, before);
  for (const Eigen::VectorXd& unit : kept) {
    sum += (unit.transpose() * draws).squaredNorm();
  }
  return kept.empty() ? 1.0 : sum / static_cast<double>(kept.size() * kUnitDraws);
}

Eigen::MatrixXd parameterCovariance(const Dataset& data, const ModelFit& fit, int replicates,
                                    std::uint64_t seed) {
  const Eigen::MatrixXd slope = fit.weighting->apply(fit.tangent);
  Eigen::MatrixXd tangent(slope.rows() + slope.cols(), slope.cols());
  tangent.topRows(slope.rows()) = slope;
  tangent.bottomRows(slope.cols()) = fit.prior_weight.asDiagonal();
  std::mt19937_64 random(seed);
  const Eigen::MatrixXd draws = weightedDraws(data, fit, replicates, random);
  const auto decomposition = tangent.completeOrthogonalDecomposition();
  const Eigen::MatrixXd solutions = decomposition.solve(draws);
  // The residual that the noise was learned from had already lost what the parameters took up.
  const double left = (draws - tangent * solutions).topRows(slope.rows()).squaredNorm() /
                      draws.topRows(slope.rows()).squaredNorm();
  return solutions * solutions.transpose() / (static_cast<double>(replicates) * std::max(0.1, left));
}

double exceedance(std::span<const double> values, double observed) {
  const auto reached = std::count_if(values.begin(), values.end(), [=](double v) { return v >= observed; });
  return (1.0 + static_cast<double>(reached)) / (1.0 + static_cast<double>(values.size()));
}

}  // namespace patella::diagnose
