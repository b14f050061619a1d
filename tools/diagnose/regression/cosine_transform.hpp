// The cosine transform of a stretch of samples.
#pragma once

#include <Eigen/Core>

#include "tools/diagnose/regression/fft_plan.hpp"

namespace patella::diagnose {

/// Orthonormal DCT-II, whose even continuation leaks less than the Fourier transform's jump. Coefficient k
/// belongs to the frequency rate·k / (2·length). Several threads may have one each.
class CosineTransform {
 public:
  explicit CosineTransform(Eigen::Index length);
  /// The result lasts until the next call.
  const Eigen::VectorXd& of(const Eigen::Ref<const Eigen::VectorXd>& stretch);

 private:
  Eigen::VectorXd values_;
  FftPlan plan_;
};

}  // namespace patella::diagnose
