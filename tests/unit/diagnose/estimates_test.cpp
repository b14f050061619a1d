#include "tools/diagnose/search/estimates.hpp"

#include <array>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/swinging_joint.hpp"

namespace patella::diagnose {
namespace {

constexpr double kSmoothing_rad_s = 0.05;

/// A fit with one term of this kind, whose torque is that of its first coefficients: three columns of a
/// recording of four rows, then the slopes by its shape, which are zero but for the first.
ModelFit fitWith(const char* kind, const Eigen::Vector4d& by_first_shape) {
  const Dataset data(std::array{swinging(20.0, 0.01, [](const Motion&) { return 0.0; })}, DatasetOptions{});
  const std::vector<std::string> kinds{kind};
  const auto found = recipes(data, pendulum().mechanism, kinds, {}, std::array{kSmoothing_rad_s});
  REQUIRE_FALSE(found.empty());
  ModelFit fit;
  Term term{.recipe = found.front(), .c = {}, .nu = {}, .declared = false, .prior_c = {}, .replaced = {}};
  term.c.assign(term.recipe->coefficients(), 1.0);
  term.nu.assign(term.recipe->nonlinear.size(), 0.0);
  const auto coefficients = static_cast<Eigen::Index>(term.c.size());
  fit.tangent =
      Eigen::MatrixXd::Zero(4, coefficients + static_cast<Eigen::Index>(term.recipe->nonlinear.size()));
  fit.tangent.leftCols(coefficients) = Eigen::MatrixXd::Identity(4, coefficients);
  if (!term.nu.empty()) {
    fit.tangent.col(coefficients) = by_first_shape;
  }
  fit.offset = {0};
  fit.terms.push_back(std::move(term));
  return fit;
}

TEST_CASE("a torque is known whose strength and slope are not, as they make up for each other") {
  // The slope does to the torque just what the first strength does.
  const ModelFit fit = fitWith("passive_knee_moment", Eigen::Vector4d::Unit(0));
  const auto parameters = fit.tangent.cols();
  Eigen::MatrixXd covariance = 1e-4 * Eigen::MatrixXd::Identity(parameters, parameters);
  covariance(0, 0) = covariance(3, 3) = 9.0;
  CHECK(torqueError(fit, covariance, 0).value() > 5.0);
  covariance(0, 3) = covariance(3, 0) = -9.0;
  // Two strengths of 1 each, of which 0.01 is uncertain: the first together with its slope not at all.
  const double known = torqueError(fit, covariance, 0).value();
  CHECK(known == doctest::Approx(kDeviations95 * 0.01 / std::sqrt(2.0)));
}

TEST_CASE("what the constant beside the strengths can make is none of theirs") {
  // The first strength's column is the constant's, and so is what is uncertain of it.
  ModelFit fit = fitWith("passive_knee_moment", Eigen::Vector4d::Zero());
  fit.tangent.col(0) = fit.tangent.col(2);
  const auto parameters = fit.tangent.cols();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(parameters, parameters);
  covariance(0, 0) = covariance(2, 2) = 100.0;
  covariance(1, 1) = 0.01;
  CHECK(torqueError(fit, covariance, 0).value() == doctest::Approx(kDeviations95 * 0.1));
}

TEST_CASE("an effect whose strength is a parameter by itself has no such error") {
  const ModelFit fit = fitWith("coulomb_friction", Eigen::Vector4d::Zero());
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(fit.tangent.cols(), fit.tangent.cols());
  CHECK_FALSE(torqueError(fit, covariance, 0).has_value());
}

}  // namespace
}  // namespace patella::diagnose
