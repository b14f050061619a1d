#include "tools/diagnose/regression/filtered_products.hpp"

#include <array>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tools/diagnose/regression/gram.hpp"

namespace patella::diagnose {
namespace {

Eigen::MatrixXd drawn(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST_CASE("products of filtered columns are those of weighted ones, under any filter and scale") {
  const Recording recording = moved(uprightChain(3), 20.0, 0.01);
  const Dataset data(std::span(&recording, 1), {});
  const Eigen::Index rows = data.rows() * data.joints();
  Eigen::MatrixXd columns = drawn(rows, 7, 1);
  // Parameters of the last link are felt by all joints, and those of the first by the first only.
  columns.col(0).tail(2 * data.rows()).setZero();
  columns.col(1).tail(data.rows()).setZero();
  columns.col(5).head(2 * data.rows()).setZero();
  // Joints whose noise goes together.
  Eigen::VectorXd residual = drawn(rows, 1, 2);
  residual.tail(data.rows()) += 0.7 * residual.head(data.rows());
  const Weighting weighting(data, residual);
  const FilteredProducts staying(weighting, columns.leftCols(4));
  const FilteredProducts all = staying.with(weighting, columns.rightCols(3));
  const auto agree = [&](const FilteredProducts& products, const Weighting& under) {
    const Eigen::MatrixXd weighted = under.apply(columns);
    const Eigen::MatrixXd expected = weighted.transpose() * weighted;
    CHECK((products.gram(under.precision()) - expected).norm() < 1e-10 * expected.norm());
  };
  agree(all, weighting);
  agree(all, weighting.rescaled(drawn(rows, 1, 3)));

  const std::array joints{1};
  Eigen::VectorXd slow = residual;
  for (Eigen::Index i = data.rows() + 1; i < 2 * data.rows(); ++i) {
    slow[i] += 0.95 * slow[i - 1];
  }
  const Weighting other = weighting.refiltered(slow, joints);
  agree(all.refiltered(other, columns, joints), other);
  // The filter of the second joint differs, and those of the others do not.
  const Eigen::MatrixXd before = weighting.filtered(columns), after = other.filtered(columns);
  const Eigen::Index count = weighting.rows();
  CHECK((after - before).middleRows(count, count).norm() > 0.1 * before.middleRows(count, count).norm());
  CHECK((after - before).topRows(count).norm() == 0.0);
  CHECK((after - before).bottomRows(count).norm() == 0.0);
}

TEST_CASE("blocks of time add up to the whole") {
  const Eigen::MatrixXd columns = drawn(3 * 101, 4, 5);
  const std::vector<Eigen::MatrixXd> blocks = gramsByTime(columns, 101, 20);
  REQUIRE(blocks.size() == 20);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(4, 4);
  for (const Eigen::MatrixXd& block : blocks) {
    sum += block;
  }
  CHECK((sum - columns.transpose() * columns).norm() < 1e-9);
  CHECK((blocks.front() - columns.topRows(5).transpose() * columns.topRows(5)).norm() > 0.1);
}

}  // namespace
}  // namespace patella::diagnose
