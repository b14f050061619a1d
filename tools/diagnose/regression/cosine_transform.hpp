// The cosine transform of a stretch of samples.
#pragma once

#include <memory>

#include <Eigen/Core>

struct fftw_plan_s;

namespace patella::diagnose {

/// Orthonormal DCT-II, whose even continuation leaks less than the Fourier transform's jump. Coefficient k
/// belongs to the frequency rate·k / (2·length). Several threads may have one each.
class CosineTransform {
 public:
  explicit CosineTransform(Eigen::Index length);
  /// The result lasts until the next call.
  const Eigen::VectorXd& of(const Eigen::Ref<const Eigen::VectorXd>& stretch);

 private:
  struct Destroy {
    void operator()(fftw_plan_s* plan) const;
  };
  Eigen::VectorXd values_;
  std::unique_ptr<fftw_plan_s, Destroy> plan_;
};

}  // namespace patella::diagnose
