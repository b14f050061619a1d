#include "tools/diagnose/search/missed.hpp"

#include <algorithm>
#include <cmath>

namespace patella::diagnose {
namespace {

double squareOf(const ModelFitter& fitter, const ModelFit& fit, std::size_t joint) {
  const Eigen::Index rows = fitter.data().rows();
  return fit.residual.segment(static_cast<Eigen::Index>(joint) * rows, rows).squaredNorm();
}

// `square`: sum of a joint's squares, N²·m².
template <class Square>
bool anyJointMisses(const ModelFitter& fitter, const Square& square) {
  const std::vector<double>& least_Nm = fitter.leastTorque_Nm();
  const auto rows = static_cast<double>(fitter.data().rows());
  for (std::size_t joint = 0; joint < least_Nm.size(); ++joint) {
    if (square(joint) > rows * std::pow(least_Nm[joint], 2)) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool restIsMissed(const ModelFitter& fitter, const ModelFit& fit) {
  return anyJointMisses(fitter, [&](std::size_t joint) { return squareOf(fitter, fit, joint); });
}

bool knownIsMoved(const ModelFit& fit) {
  return fit.prior_residual.size() > 0 &&
         fit.prior_residual.cwiseAbs2().maxCoeff() >= accepted::kMoved * fit.redundancy();
}

bool gainIsMissed(const ModelFitter& fitter, const ModelFit& smaller, const ModelFit& larger) {
  return anyJointMisses(fitter, [&](std::size_t joint) {
    return squareOf(fitter, smaller, joint) - squareOf(fitter, larger, joint);
  });
}

double priorRelief(const ModelFit& smaller, const ModelFit& larger) {
  double relief = smaller.prior_residual.squaredNorm() - larger.prior_residual.squaredNorm();
  for (std::size_t t = 0; t < smaller.terms.size(); ++t) {
    const Term& term = smaller.terms[t];
    const bool is_replaced = std::any_of(larger.terms.begin(), larger.terms.end(), [&](const Term& other) {
      return std::any_of(other.replaced.begin(), other.replaced.end(), [&](const Term& old) {
        return old.recipe == term.recipe && other.recipe->kind != term.recipe->kind;
      });
    });
    if (is_replaced) {
      relief -= smaller.prior_residual
                    .segment(smaller.offset[t], static_cast<Eigen::Index>(term.c.size() + term.nu.size()))
                    .squaredNorm();
    }
  }
  return relief / larger.redundancy();
}

}  // namespace patella::diagnose
