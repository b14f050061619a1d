#include "tools/diagnose/evidence/moments.hpp"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"

namespace patella::diagnose::evidence {
namespace {

TEST_CASE("products of columns over all bands are the columns' own") {
  const Recording recording = swinging(30.0, 0.0, [](const Motion&) { return 0.0; });
  const Dataset data(std::span(&recording, 1), {.evaluation_rate_Hz = 200.0, .band_Hz = 10.0});
  Moments moments(data);
  Eigen::MatrixXd columns(data.rows(), 2);
  for (Eigen::Index i = 0; i < data.rows(); ++i) {
    // Far below the edge, and smooth at the ends of the stretch.
    const double x = static_cast<double>(i) / static_cast<double>(data.rows() - 1);
    columns(i, 0) = std::exp(-20.0 * (x - 0.4) * (x - 0.4));
    columns(i, 1) = std::exp(-20.0 * (x - 0.6) * (x - 0.6));
  }
  const Eigen::Index first = moments.append(columns);
  REQUIRE(first == 0);
  REQUIRE(moments.columns() == 2);
  double product = 0.0;
  for (int b = 0; b < moments.bands(); ++b) {
    product += moments.products(0, b)(0, 1);
  }
  CHECK(product == doctest::Approx(columns.col(0).dot(columns.col(1))).epsilon(1e-6));
  CHECK(moments.square(0, 1) == doctest::Approx(columns.col(1).squaredNorm()).epsilon(1e-6));
}

TEST_CASE("a sinusoid has its power in its band") {
  const Recording recording = swinging(40.0, 0.0, [](const Motion&) { return 0.0; });
  const Dataset data(std::span(&recording, 1), {.evaluation_rate_Hz = 200.0, .band_Hz = 10.0});
  Moments moments(data);
  Eigen::VectorXd sinusoid(data.rows());
  for (Eigen::Index i = 0; i < data.rows(); ++i) {
    sinusoid[i] = std::sin(2.0 * std::numbers::pi * 2.9 * data.time_s()[i]);
  }
  moments.append(sinusoid);
  for (int b = 0; b < moments.bands(); ++b) {
    const auto band = static_cast<std::size_t>(b);
    const bool inside = moments.edges_Hz()[band] < 2.9 && 2.9 < moments.edges_Hz()[band + 1];
    const double share = moments.products(0, b)(0, 0) / sinusoid.squaredNorm();
    CHECK((inside ? share > 0.95 : share < 0.05));
  }
}

TEST_CASE("bands are octaves that hold coefficients enough to tell their level") {
  for (const double duration_s : {5.0, 20.0, 60.0}) {
    const Recording recording = swinging(duration_s, 0.0, [](const Motion&) { return 0.0; });
    const Dataset data(std::span(&recording, 1), {.evaluation_rate_Hz = 200.0, .band_Hz = 10.0});
    const Moments moments(data);
    double all = 0.0;
    for (int b = 0; b < moments.bands(); ++b) {
      CHECK(moments.coefficients(b) >= 6.0);
      all += moments.coefficients(b);
    }
    CHECK(all == moments.coefficients());
    CHECK(moments.edges_Hz().back() == data.band_Hz());
  }
}

}  // namespace
}  // namespace patella::diagnose::evidence
