#include "tools/diagnose/search/search.hpp"

#include <algorithm>
#include <cmath>
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

// The part of the columns that is not spanned already; `before` are their squared lengths before something
// was taken out of them.
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

}  // namespace

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

FreeColumns freeColumns(const ModelFit& fit, const Eigen::VectorXd& prior_weight,
                        const Eigen::MatrixXd& nuisance) {
  const Eigen::MatrixXd slope = fit.weighting->apply(fit.tangent);
  FreeColumns free{
      .weighted = Eigen::MatrixXd::Zero(slope.rows() + slope.cols(), slope.cols() + nuisance.cols()),
      .length = {}};
  free.weighted.topLeftCorner(slope.rows(), slope.cols()) = slope;
  free.weighted.bottomLeftCorner(slope.cols(), slope.cols()) = prior_weight.asDiagonal();
  if (nuisance.cols() > 0) {
    free.weighted.topRightCorner(slope.rows(), nuisance.cols()) = fit.weighting->apply(nuisance);
  }
  const Eigen::VectorXd length = free.weighted.colwise().norm();
  free.length = (length.array() > 0.0).select(length, 1.0);
  free.weighted = free.weighted * free.length.cwiseInverse().asDiagonal();
  return free;
}

Eigen::MatrixXd takenUp(const ModelFit& fit, const Eigen::VectorXd& prior_weight,
                        const Eigen::MatrixXd& nuisance) {
  const FreeColumns free = freeColumns(fit, prior_weight, nuisance);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(free.weighted);
  qr.setThreshold(kSpanned);
  return qr.householderQ() * Eigen::MatrixXd::Identity(free.weighted.rows(), qr.rank());
}

Eigen::MatrixXd Atoms::of(const Atom& atom) const {
  return isOscillation(atom) ? oscillationColumns(*data, atom.joint, atom.nu.front())
                             : Eigen::MatrixXd(columns.middleCols(atom.first, atom.count));
}

std::optional<int> Atoms::onlyJoint(const Atom& atom) const {
  if (isOscillation(atom)) {
    return atom.joint;
  }
  const auto own = columns.middleCols(atom.first, atom.count);
  for (int joint = 0; joint < data->joints(); ++joint) {
    if (joint != atom.joint && !own.middleRows(joint * data->rows(), data->rows()).isZero(0.0)) {
      return {};
    }
  }
  return atom.joint;
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
