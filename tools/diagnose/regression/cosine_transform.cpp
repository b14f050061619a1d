#include "tools/diagnose/regression/cosine_transform.hpp"

#include <cmath>

#include <fftw3.h>

namespace patella::diagnose {

CosineTransform::CosineTransform(Eigen::Index length)
    : values_(length), plan_([&] {
        return fftw_plan_r2r_1d(static_cast<int>(length), values_.data(), values_.data(), FFTW_REDFT10,
                                FFTW_ESTIMATE);
      }) {}

const Eigen::VectorXd& CosineTransform::of(const Eigen::Ref<const Eigen::VectorXd>& stretch) {
  values_ = stretch;
  plan_.run();
  const auto length = static_cast<double>(values_.size());
  values_ /= std::sqrt(2.0 * length);
  values_[0] /= std::sqrt(2.0);
  return values_;
}

}  // namespace patella::diagnose
