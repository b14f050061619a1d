#include "core/estimation/low_pass_observer.hpp"

#include <stdexcept>
#include <utility>

#include "core/signal/butterworth.hpp"

namespace patella::estimation {
namespace {

constexpr int kOrder = 2;

}  // namespace

LowPassObserver::LowPassObserver(std::unique_ptr<Observer> observer, const PerJoint& cutoff_Hz,
                                 double rate_Hz)
    : observer_(std::move(observer)) {
  if (!observer_) {
    throw std::invalid_argument("LowPassObserver: the observer is null, expected one");
  }
  for (const double cutoff : cutoff_Hz) {
    filters_.push_back(signal::lowPass(kOrder, cutoff, rate_Hz));
  }
}

void LowPassObserver::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  observer_->reset(input);
  for (signal::BiquadCascade& filter : filters_) {
    filter.reset(0.0);
  }
}

JointVector LowPassObserver::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  JointVector estimate = observer_->update(input);
  for (Eigen::Index joint = 0; joint < estimate.size(); ++joint) {
    estimate[joint] = filters_[static_cast<std::size_t>(joint)].step(estimate[joint]);
  }
  return estimate;
}

}  // namespace patella::estimation
