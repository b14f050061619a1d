#include "tools/diagnose/fit/link_body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "core/bounds/bounds.hpp"

namespace patella::diagnose {
namespace {

/// Of the largest: below it a principal second moment is rounding.
constexpr double kMomentRounding = 1e-9;

Eigen::Matrix3d tensorOf(const model::ChainLink& link) {
  const auto [xx, yy, zz, xy, xz, yz] = link.inertia_kg_m2;
  Eigen::Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return tensor;
}

/// Trace and tensor of inertia from second moments, and the other way round, differ by this factor.
Eigen::Matrix3d complement(const Eigen::Matrix3d& moments, double factor) {
  return factor * moments.trace() * Eigen::Matrix3d::Identity() - moments;
}

/// F with F Fᵀ the symmetric matrix, whose eigenvalues below rounding count as 0.
Eigen::Matrix3d factorOf(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::Vector3d size = solver.eigenvalues().unaryExpr(
      [=](double value) { return value > kMomentRounding * largest ? value : 0.0; });
  return solver.eigenvectors() * size.cwiseSqrt().asDiagonal();
}

/// The identity at 0. Off the diagonal by √2 less, which makes the same spread of all six a spread of the
/// second moments that is the same in all directions.
Eigen::Matrix3d stretch(const LinkBody::Numbers& x) {
  Eigen::Matrix3d matrix;
  matrix << std::exp(0.5 * x[1]), x[4] / std::numbers::sqrt2, x[5] / std::numbers::sqrt2,  //
      0.0, std::exp(0.5 * x[2]), x[6] / std::numbers::sqrt2,                               //
      0.0, 0.0, std::exp(0.5 * x[3]);
  return matrix;
}

}  // namespace

LinkBody::LinkBody(const model::ChainLink& nominal) : nominal_(nominal) {
  const Eigen::Matrix3d central = complement(tensorOf(nominal), 0.5) / nominal.mass_kg;
  extent_ = factorOf(central);
  const Eigen::Matrix3d about_origin =
      extent_ * extent_.transpose() + nominal.com_m * nominal.com_m.transpose();
  reach_ = factorOf(about_origin);
  const double square_m2 = about_origin.trace();
  sizes_ = {nominal.mass_kg * square_m2, nominal.mass_kg * std::sqrt(square_m2), nominal.mass_kg};
}

model::ChainLink LinkBody::at(const Numbers& x) const {
  model::ChainLink link = nominal_;
  link.mass_kg = std::min(nominal_.mass_kg * std::exp(x[kLogMass]),
                          boundOf("mechanism.link.mass_kg (serial_chain)").maximum);
  const Bound place = boundOf("mechanism.link.com_m (serial_chain)");
  link.com_m = (nominal_.com_m + reach_ * x.tail<3>()).cwiseMax(place.minimum).cwiseMin(place.maximum);
  const Eigen::Matrix3d factor = extent_ * stretch(x);
  Eigen::Matrix3d inertia = complement(link.mass_kg * factor * factor.transpose(), 1.0);
  const double most = boundOf("mechanism.link.inertia_kg_m2 (serial_chain)").maximum;
  inertia *= std::min(1.0, most / std::max(inertia.cwiseAbs().maxCoeff(), most));
  link.inertia_kg_m2 = {inertia(0, 0), inertia(1, 1), inertia(2, 2),
                        inertia(0, 1), inertia(0, 2), inertia(1, 2)};
  return link;
}

}  // namespace patella::diagnose
