#include "tools/diagnose/regression/cosine_transform.hpp"

#include <cmath>
#include <mutex>

#include <fftw3.h>

namespace patella::diagnose {
namespace {

// FFTW plans in one thread at a time (its manual, "Thread safety"); executing is safe.
std::mutex g_planner;  // NOLINT: the library's planner is one for the process

}  // namespace

void CosineTransform::Destroy::operator()(fftw_plan plan) const {
  const std::lock_guard lock(g_planner);
  fftw_destroy_plan(plan);
}

CosineTransform::CosineTransform(Eigen::Index length) : values_(length) {
  const std::lock_guard lock(g_planner);
  plan_.reset(fftw_plan_r2r_1d(static_cast<int>(length), values_.data(), values_.data(), FFTW_REDFT10,
                               FFTW_ESTIMATE));
}

const Eigen::VectorXd& CosineTransform::of(const Eigen::Ref<const Eigen::VectorXd>& stretch) {
  values_ = stretch;
  fftw_execute(plan_.get());
  const auto length = static_cast<double>(values_.size());
  values_ /= std::sqrt(2.0 * length);
  values_[0] /= std::sqrt(2.0);
  return values_;
}

}  // namespace patella::diagnose
