#include "tools/diagnose/regression/noise_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace patella::diagnose {
namespace {

// Keeps the equations solvable where a joint does not move and its residual is nothing but zero.
constexpr double kSmallestVariance = 1e-18;
/// Orders of the two autoregressions. The weighting's white share bounds how much more a calm frequency may
/// count than a loud one: with the full process, slow errors of the model would count for nothing.
constexpr int kWeightingOrder = 4;
constexpr double kWeightingWhiteShare = 0.5;
constexpr int kHighestProcessOrder = 10;
constexpr int kBurnIn = 200;
/// Share of the rows that an autoregression may lose to the beginnings of blocks: a process that is known
/// from a few rows of many short blocks leaves nothing of them, and calls everything more than chance.
constexpr double kMostLost = 0.5;
/// Share that noise keeps from one row to the next, at most.
constexpr double kSlowestDecay = 0.999;

/// A Column less the mean of each joint's rows. A constant torque is no noise: taken for some, it would pass
/// for a process that never comes back, against which no constant shows.
Eigen::VectorXd centred(const Dataset& data, const Eigen::VectorXd& residual) {
  Eigen::VectorXd result = residual;
  for (int joint = 0; joint < data.joints(); ++joint) {
    auto rows = result.segment(joint * data.rows(), data.rows());
    rows.array() -= rows.mean();
  }
  return result;
}

/// Calls visit(first row among a joint's innovations, its row among the joint's rows, rows) for each block.
template <typename Visit>
void eachRun(const Autoregression& process, const Dataset& data, Visit visit) {
  Eigen::Index at = 0;
  for (const Block& block : data.blocks()) {
    const Eigen::Index count = block.end - block.first - process.order;
    if (count > 0) {
      visit(at, block.first + process.order, count);
      at += count;
    }
  }
}

// Sums of e_(t−a)·e_(t−b) of a joint's residual, a and b up to `lags`, over all t of the blocks from their
// row number `lags` on. Along a diagonal they differ at the blocks' ends only.
Eigen::MatrixXd laggedProducts(const Dataset& data, const Eigen::VectorXd& residual, int joint, int lags) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(lags + 1, lags + 1);
  const auto e = residual.segment(joint * data.rows(), data.rows());
  for (const Block& block : data.blocks()) {
    const Eigen::Index count = block.end - block.first - lags;
    if (count <= 0) {
      continue;
    }
    const Eigen::Index first = block.first + lags;
    for (int apart = 0; apart <= lags; ++apart) {
      double sum = e.segment(first, count).dot(e.segment(first - apart, count));
      sums(apart, 0) += sum;
      for (int b = 1; b + apart <= lags; ++b) {
        sum += e[first - b] * e[first - b - apart] - e[block.end - b] * e[block.end - b - apart];
        sums(b + apart, b) += sum;
      }
    }
  }
  return sums.selfadjointView<Eigen::Lower>();
}

/// Whether a process e_t = Σ a_k e_(t−k) comes back to zero: the Levinson recursion downwards has partial
/// autocorrelations below 1 only (Schur and Cohn).
bool comesBack(Eigen::VectorXd a) {
  for (Eigen::Index order = a.size(); order > 0; --order) {
    const double last = a[order - 1];
    if (!(std::abs(last) < 1.0)) {
      return false;
    }
    const Eigen::VectorXd rest = a.head(order - 1);
    a = (rest + last * rest.reverse()) / (1.0 - last * last);
  }
  return true;
}

/// Brings a process back that is known from so few rows that it grows without end.
void dampGrowth(Eigen::VectorXd& a) {
  if (comesBack(a)) {
    return;
  }
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(a.size(), a.size());
  companion.diagonal(-1).setOnes();
  companion.row(0) = a.transpose();
  const double ratio = kSlowestDecay / companion.eigenvalues().cwiseAbs().maxCoeff();
  double factor = 1.0;
  for (double& coefficient : a) {
    factor *= ratio;
    coefficient *= factor;
  }
}

/// The order, or the highest below it that the lengths of the blocks allow.
int affordable(const Dataset& data, int order) {
  const auto lost = [&](int of) {
    return static_cast<double>(data.rows() - Autoregression{.order = of, .coefficients = {}}.rows(data));
  };
  while (order > 0 && lost(order) > kMostLost * static_cast<double>(data.rows())) {
    --order;
  }
  return data.isStatic() ? 0 : order;
}

}  // namespace

Autoregression Autoregression::fit(const Dataset& data, const Eigen::VectorXd& residual, int order,
                                   double white_share) {
  Autoregression result{.order = affordable(data, order), .coefficients = {}};
  const int lags = result.order;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const Eigen::MatrixXd products = laggedProducts(data, residual, joint, lags);
    Eigen::MatrixXd normal = products.bottomRightCorner(lags, lags);
    const double small = kSmallestVariance * static_cast<double>(data.rows());
    normal.diagonal() *= 1.0 + white_share + 1e-9;
    normal.diagonal().array() += small;
    result.coefficients[static_cast<std::size_t>(joint)] = normal.ldlt().solve(products.col(0).tail(lags));
  }
  return result;
}

Eigen::Index Autoregression::rows(const Dataset& data) const {
  Eigen::Index count = 0;
  for (const Block& block : data.blocks()) {
    count += std::max<Eigen::Index>(0, block.end - block.first - order);
  }
  return count;
}

Eigen::VectorXd Autoregression::innovationsOf(const Dataset& data, int joint,
                                              const Eigen::Ref<const Eigen::VectorXd>& column) const {
  const Eigen::VectorXd& a = coefficients[static_cast<std::size_t>(joint)];
  Eigen::VectorXd result(rows(data));
  eachRun(*this, data, [&](Eigen::Index at, Eigen::Index first, Eigen::Index count) {
    auto out = result.segment(at, count);
    out = column.segment(first, count);
    // Most effects act on one joint of up to eight.
    if (column.segment(first - order, count + order).isZero(0.0)) {
      return;
    }
    const auto lagged = [&](int k) { return column.segment(first - 1 - k, count); };
    int k = 0;
    // Four at a time: what this takes is reading and writing.
    for (; k + 4 <= order; k += 4) {
      out -=
          a[k] * lagged(k) + a[k + 1] * lagged(k + 1) + a[k + 2] * lagged(k + 2) + a[k + 3] * lagged(k + 3);
    }
    for (; k < order; ++k) {
      out -= a[k] * lagged(k);
    }
  });
  return result;
}

Eigen::VectorXd Autoregression::innovations(const Dataset& data,
                                            const Eigen::Ref<const Eigen::VectorXd>& column) const {
  const Eigen::Index count = rows(data);
  Eigen::VectorXd result(count * data.joints());
  for (int joint = 0; joint < data.joints(); ++joint) {
    result.segment(joint * count, count) =
        innovationsOf(data, joint, column.segment(joint * data.rows(), data.rows()));
  }
  return result;
}

Eigen::VectorXd Autoregression::transposed(const Dataset& data, const Eigen::VectorXd& innovations) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(data.rows() * data.joints());
  for (int joint = 0; joint < data.joints(); ++joint) {
    const Eigen::VectorXd& a = coefficients[static_cast<std::size_t>(joint)];
    auto out = result.segment(joint * data.rows(), data.rows());
    const auto all = innovations.segment(joint * rows(data), rows(data));
    eachRun(*this, data, [&](Eigen::Index at, Eigen::Index first, Eigen::Index count) {
      const auto in = all.segment(at, count);
      out.segment(first, count) += in;
      for (int k = 0; k < order; ++k) {
        out.segment(first - 1 - k, count) -= a[k] * in;
      }
    });
  }
  return result;
}

Weighting::Weighting(const Dataset& data, const Eigen::VectorXd& residual)
    : data_(&data),
      filter_(Autoregression::fit(data, centred(data, residual), kWeightingOrder, kWeightingWhiteShare)),
      rows_(filter_.rows(data)) {
  scaleTo(residual);
}

Weighting Weighting::rescaled(const Eigen::VectorXd& residual) const {
  Weighting result = *this;
  result.scaleTo(residual);
  return result;
}

Weighting Weighting::refiltered(const Eigen::VectorXd& residual, std::span<const int> joints) const {
  Weighting result = *this;
  const Weighting whole(*data_, residual);
  for (const int joint : joints) {
    const auto number = static_cast<std::size_t>(joint);
    result.filter_.coefficients[number] = whole.filter_.coefficients[number];
  }
  result.scaleTo(residual);
  return result;
}

Weighting Weighting::jointByJoint() const {
  Weighting result = *this;
  result.apart_ = true;
  result.inverse_root_ = inverse_root_.inverse().rowwise().norm().cwiseInverse().asDiagonal();
  return result;
}

double Weighting::correlation() const {
  Eigen::MatrixXd root = inverse_root_.inverse();
  root.rowwise().normalize();
  Eigen::MatrixXd correlations = root * root.transpose();
  correlations.diagonal().setZero();
  return correlations.cwiseAbs().maxCoeff();
}

Eigen::MatrixXd Weighting::covariance(const Eigen::VectorXd& residual) const {
  const Eigen::VectorXd weighted = filter_.innovations(*data_, residual);
  const Eigen::Map<const Eigen::MatrixXd> joints(weighted.data(), rows_, data_->joints());
  Eigen::MatrixXd result = joints.transpose() * joints / static_cast<double>(rows_);
  result.diagonal().array() += kSmallestVariance;
  if (apart_) {
    result = Eigen::MatrixXd(result.diagonal().asDiagonal());
  }
  return result;
}

void Weighting::scaleTo(const Eigen::VectorXd& residual) {
  // The lower triangle of the joints in reverse order.
  const Eigen::LLT<Eigen::MatrixXd> root(covariance(residual).reverse().eval());
  inverse_root_ = root.matrixL().solve(Eigen::MatrixXd::Identity(data_->joints(), data_->joints())).reverse();
}

Eigen::MatrixXd Weighting::filtered(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  Eigen::MatrixXd result(rows_ * data_->joints(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    result.col(c) = filter_.innovations(*data_, columns.col(c));
  }
  return result;
}

Eigen::MatrixXd Weighting::filteredOf(int joint, const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  Eigen::MatrixXd result(rows_, columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    result.col(c) =
        filter_.innovationsOf(*data_, joint, columns.col(c).segment(joint * data_->rows(), data_->rows()));
  }
  return result;
}

Eigen::MatrixXd Weighting::apply(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  const int joints = data_->joints();
  Eigen::MatrixXd result(rows_ * joints, columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const Eigen::VectorXd weighted = filter_.innovations(*data_, columns.col(c));
    result.col(c).setZero();
    for (int joint = 0; joint < joints; ++joint) {
      const auto own = weighted.segment(joint * rows_, rows_);
      if (own.isZero(0.0)) {
        continue;
      }
      for (int row = 0; row <= joint; ++row) {
        result.col(c).segment(row * rows_, rows_) += inverse_root_(row, joint) * own;
      }
    }
  }
  return result;
}

Eigen::MatrixXd Weighting::gathered(const Eigen::Ref<const Eigen::MatrixXd>& weighted) const {
  const int joints = data_->joints();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows_ * joints, weighted.cols());
  for (Eigen::Index c = 0; c < weighted.cols(); ++c) {
    for (int joint = 0; joint < joints; ++joint) {
      for (int row = 0; row <= joint; ++row) {
        result.col(c).segment(joint * rows_, rows_) +=
            inverse_root_(row, joint) * weighted.col(c).segment(row * rows_, rows_);
      }
    }
  }
  return result;
}

Eigen::MatrixXd Weighting::transposed(const Eigen::Ref<const Eigen::MatrixXd>& weighted) const {
  const Eigen::MatrixXd of_joints = gathered(weighted);
  Eigen::MatrixXd result(data_->rows() * data_->joints(), weighted.cols());
  for (Eigen::Index c = 0; c < weighted.cols(); ++c) {
    result.col(c) = filter_.transposed(*data_, of_joints.col(c));
  }
  return result;
}

double Weighting::objective(const Eigen::VectorXd& residual) const {
  const Eigen::LLT<Eigen::MatrixXd> root(covariance(residual));
  const Eigen::MatrixXd factor = root.matrixL();
  return 2.0 * static_cast<double>(rows_) * factor.diagonal().array().log().sum();
}

NoiseProcess::NoiseProcess(const Dataset& data, const Eigen::VectorXd& whole) : data_(&data) {
  const Eigen::VectorXd residual = centred(data, whole);
  double least = std::numeric_limits<double>::infinity();
  const int highest = affordable(data, kHighestProcessOrder);
  for (int order = 0; order <= highest; ++order) {
    Autoregression candidate = Autoregression::fit(data, residual, order, 0.0);
    for (int joint = 0; joint < data.joints(); ++joint) {
      dampGrowth(candidate.coefficients[static_cast<std::size_t>(joint)]);
    }
    const Eigen::VectorXd all = candidate.innovations(data, residual);
    const Eigen::Index rows = candidate.rows(data);
    const Eigen::Map<const Eigen::MatrixXd> joints(all.data(), rows, data.joints());
    Eigen::MatrixXd covariance = joints.transpose() * joints / static_cast<double>(rows);
    covariance.diagonal().array() += kSmallestVariance;
    // Bayesian information criterion, per row, since a higher order has fewer of them.
    const auto n = static_cast<double>(rows);
    const double criterion = std::log(covariance.determinant()) + order * data.joints() * std::log(n) / n;
    if (criterion < least) {
      least = criterion;
      process_ = candidate;
      innovations_ = joints;
    }
  }
}

Eigen::VectorXd NoiseProcess::draw(std::mt19937_64& random) const {
  const auto rows = static_cast<std::uint64_t>(innovations_.rows());
  Eigen::VectorXd result(data_->rows() * data_->joints());
  const int order = process_.order;
  for (const Block& block : data_->blocks()) {
    const Eigen::Index count = block.end - block.first;
    Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(count + kBurnIn + order, data_->joints());
    for (Eigen::Index t = order; t < noise.rows(); ++t) {
      // One number for both: its upper half chooses the row, its last bit the sign.
      const std::uint64_t number = random();
      const auto row = static_cast<Eigen::Index>(((number >> 32) * rows) >> 32);
      const double sign = (number & 1) != 0 ? 1.0 : -1.0;
      for (int joint = 0; joint < data_->joints(); ++joint) {
        const Eigen::VectorXd& a = process_.coefficients[static_cast<std::size_t>(joint)];
        double* const value = noise.col(joint).data() + t;
        double sum = sign * innovations_(row, joint);
        // The latest value last: the processor need not wait for it until then.
        for (int k = order - 1; k >= 0; --k) {
          sum += a[k] * value[-1 - k];
        }
        *value = sum;
      }
    }
    for (int joint = 0; joint < data_->joints(); ++joint) {
      result.segment(joint * data_->rows() + block.first, count) = noise.col(joint).tail(count);
    }
  }
  return result;
}

double NoiseProcess::variance(const Eigen::Ref<const Eigen::VectorXd>& column) const {
  const int joints = data_->joints();
  const Eigen::MatrixXd covariance =
      innovations_.transpose() * innovations_ / static_cast<double>(innovations_.rows());
  double sum = 0.0;
  for (const Block& block : data_->blocks()) {
    // Contribution of an innovation to the product from its time on: the recursion of draw(), backwards.
    const Eigen::Index count = block.end - block.first;
    Eigen::MatrixXd adds = Eigen::MatrixXd::Zero(kBurnIn + count + process_.order, joints);
    for (Eigen::Index t = kBurnIn + count - 1; t >= 0; --t) {
      for (int joint = 0; joint < joints; ++joint) {
        const Eigen::VectorXd& a = process_.coefficients[static_cast<std::size_t>(joint)];
        double* const value = adds.col(joint).data() + t;
        double added = t >= kBurnIn ? column[joint * data_->rows() + block.first + t - kBurnIn] : 0.0;
        for (int k = process_.order - 1; k >= 0; --k) {
          added += a[k] * value[1 + k];
        }
        *value = added;
      }
    }
    sum += (adds * covariance).cwiseProduct(adds).sum();
  }
  return sum;
}

}  // namespace patella::diagnose
