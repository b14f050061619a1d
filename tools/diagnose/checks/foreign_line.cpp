#include "tools/diagnose/checks/foreign_line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Frequencies a resolution: a line between two of them loses less than a twentieth of its power.
constexpr double kPerResolution = 4.0;

// Sum of squares that a sinusoid takes of a signal, by least squares.
double taken(const Eigen::MatrixX2d& sinusoid, const Eigen::VectorXd& signal) {
  const Eigen::Vector2d product = sinusoid.transpose() * signal;
  const Eigen::Matrix2d gram = sinusoid.transpose() * sinusoid;
  return std::max(0.0, product.dot(gram.ldlt().solve(product)));
}

}  // namespace

double squareBesideForeignLine(const JointRows& rows, double highest_Hz) {
  const double whole = rows.rest_Nm.squaredNorm();
  const double motion = rows.velocity_rad_s.squaredNorm();
  const double duration_s = rows.time_s.maxCoeff() - rows.time_s.minCoeff();
  double least = whole;
  Eigen::MatrixX2d sinusoid(rows.time_s.size(), 2);
  for (double f = tremor::kLowest_Hz; duration_s > 0.0 && f < highest_Hz;
       f += 1.0 / (kPerResolution * duration_s)) {
    const Eigen::ArrayXd phase = 2.0 * std::numbers::pi * f * rows.time_s.array();
    sinusoid << phase.sin(), phase.cos();
    const double left = whole - taken(sinusoid, rows.rest_Nm);
    if (left < least && taken(sinusoid, rows.velocity_rad_s) <= tremor::kOfMotion * motion) {
      least = left;
    }
  }
  return std::max(0.0, least);
}

}  // namespace patella::diagnose
