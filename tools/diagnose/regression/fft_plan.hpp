// A plan of FFTW. Its planner is one for the process and works for one thread at a time; running plans is
// safe in any thread (FFTW's manual, "Thread safety").
#pragma once

#include <functional>
#include <memory>

struct fftw_plan_s;

namespace patella::diagnose {

class FftPlan {
 public:
  /// `make` calls one of FFTW's planners. The memory that it names has to outlive the plan.
  explicit FftPlan(const std::function<fftw_plan_s*()>& make);
  void run() const noexcept;

 private:
  struct Destroy {
    void operator()(fftw_plan_s* plan) const;
  };
  std::unique_ptr<fftw_plan_s, Destroy> plan_;
};

}  // namespace patella::diagnose
