#include "tools/diagnose/regression/fft_plan.hpp"

#include <mutex>

#include <fftw3.h>

namespace patella::diagnose {
namespace {

std::mutex g_planner;  // NOLINT: the library's planner is one for the process

}  // namespace

void FftPlan::Destroy::operator()(fftw_plan plan) const {
  const std::lock_guard lock(g_planner);
  fftw_destroy_plan(plan);
}

FftPlan::FftPlan(const std::function<fftw_plan_s*()>& make) {
  const std::lock_guard lock(g_planner);
  plan_.reset(make());
}

void FftPlan::run() const noexcept {
  fftw_execute(plan_.get());
}

}  // namespace patella::diagnose
